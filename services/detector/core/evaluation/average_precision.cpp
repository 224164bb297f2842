// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/evaluation/average_precision.hpp"

#include <algorithm>
#include <numeric>

#include "services/detector/core/evaluation/box_matching.hpp"

namespace rtd::detector {
namespace {

constexpr int kRecallSteps = 100;  // precision is read at recall 0, 0.01 .. 1

/// Precision and recall after each detection, those that count, best first.
struct RunningScore {
  std::vector<double> scores, precision, recall;
};

RunningScore running_score(const std::vector<JudgedDetection>& judged, std::size_t threshold, std::size_t truths) {
  RunningScore running;
  double correct = 0, wrong = 0;
  for (const JudgedDetection& detection : judged) {
    const Outcome outcome = detection.outcome[threshold];
    if (outcome == Outcome::kIgnored) continue;
    (outcome == Outcome::kCorrect ? correct : wrong) += 1;
    running.scores.push_back(detection.score);
    running.precision.push_back(correct / (correct + wrong));
    running.recall.push_back(correct / static_cast<double>(truths));
  }
  return running;
}

double average_precision(RunningScore running) {
  for (std::size_t i = running.precision.size(); i-- > 1;) {
    running.precision[i - 1] = std::max(running.precision[i - 1], running.precision[i]);
  }
  double sum = 0;
  for (int step = 0; step <= kRecallSteps; ++step) {
    const auto reached = std::lower_bound(running.recall.begin(), running.recall.end(), step / double(kRecallSteps));
    if (reached == running.recall.end()) break;
    sum += running.precision[static_cast<std::size_t>(reached - running.recall.begin())];
  }
  return sum / (kRecallSteps + 1);
}

std::vector<OperatingPoint> curve_of(const RunningScore& running) {
  std::vector<OperatingPoint> curve;
  for (std::size_t i = 0; i < running.scores.size(); ++i) {
    if (i + 1 < running.scores.size() && running.scores[i + 1] == running.scores[i]) continue;
    const double p = running.precision[i], r = running.recall[i];
    curve.push_back({running.scores[i], p, r, p + r > 0 ? 2 * p * r / (p + r) : 0});
  }
  return curve;
}

}  // namespace

double BoxAccuracy::ap50_95() const {
  return std::accumulate(ap.begin(), ap.end(), 0.0) / static_cast<double>(ap.size());
}

BoxAccuracy evaluate_boxes(const std::vector<EvaluatedImage>& images, const ClassFilter& belongs) {
  BoxAccuracy accuracy;
  std::vector<JudgedDetection> judged;
  for (const EvaluatedImage& image : images) {
    std::vector<LabelledBox> truths;
    std::vector<vision::Detection> detections;
    const auto looked_at = [&belongs](const auto& box) { return belongs(box.class_name); };
    std::copy_if(image.truths.begin(), image.truths.end(), std::back_inserter(truths), looked_at);
    std::copy_if(image.detections.begin(), image.detections.end(), std::back_inserter(detections), looked_at);
    accuracy.truths += static_cast<std::size_t>(
        std::count_if(truths.begin(), truths.end(), [](const LabelledBox& box) { return !box.difficult; }));
    const std::vector<JudgedDetection> here = judge(detections, truths);
    judged.insert(judged.end(), here.begin(), here.end());
  }
  std::stable_sort(judged.begin(), judged.end(),
                   [](const JudgedDetection& a, const JudgedDetection& b) { return a.score > b.score; });
  for (std::size_t t = 0; t < kIouThresholds.size() && accuracy.truths > 0; ++t) {
    const RunningScore running = running_score(judged, t, accuracy.truths);
    accuracy.ap[t] = average_precision(running);
    if (t > 0) continue;
    accuracy.detections = running.scores.size();
    accuracy.curve = curve_of(running);
  }
  return accuracy;
}

std::optional<OperatingPoint> best_f1(const std::vector<OperatingPoint>& curve) {
  const auto best = std::max_element(curve.begin(), curve.end(),
                                     [](const OperatingPoint& a, const OperatingPoint& b) { return a.f1 < b.f1; });
  return best == curve.end() ? std::nullopt : std::optional(*best);
}

std::optional<OperatingPoint> highest_threshold_with_recall(const std::vector<OperatingPoint>& curve, double recall) {
  const auto reached = std::find_if(curve.begin(), curve.end(),
                                    [recall](const OperatingPoint& point) { return point.recall >= recall; });
  return reached == curve.end() ? std::nullopt : std::optional(*reached);
}

OperatingPoint at_threshold(const std::vector<OperatingPoint>& curve, double threshold) {
  OperatingPoint point{threshold, 1, 0, 0};
  for (const OperatingPoint& next : curve) {
    if (next.threshold < threshold) break;
    point = {threshold, next.precision, next.recall, next.f1};
  }
  return point;
}

}  // namespace rtd::detector
