// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/detection/average_precision.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace rtd::eval {
namespace {

constexpr int kRecallSteps = 100;  // precision is read at recall 0, 0.01 .. 1

enum class Outcome : unsigned char { kWrong, kCorrect, kIgnored };

/// A detection and whether it was right, by overlap threshold.
struct JudgedDetection {
  float score = 0;
  std::array<Outcome, kIouThresholds.size()> outcome{};
};

constexpr std::size_t kMaxDetections = 100;  // of an image, as COCO takes

std::vector<vision::Detection> best_first(std::vector<vision::Detection> detections) {
  std::erase_if(detections, [](const vision::Detection& detection) { return !std::isfinite(detection.score); });
  std::ranges::stable_sort(detections, std::ranges::greater{}, &vision::Detection::score);
  if (detections.size() > kMaxDetections) detections.resize(kMaxDetections);
  return detections;
}

/// Intersection over union, [0, 1]; 0 for boxes without area.
double overlap(const vision::Detection& detection, const LabelledBox& truth) {
  const double width_px = std::min<double>(detection.x_px + detection.width_px, truth.x_px + truth.width_px) -
                          std::max<double>(detection.x_px, truth.x_px);
  const double height_px = std::min<double>(detection.y_px + detection.height_px, truth.y_px + truth.height_px) -
                           std::max<double>(detection.y_px, truth.y_px);
  if (!(width_px > 0 && height_px > 0)) return 0;
  const double both = width_px * height_px;
  return both / (double(detection.width_px) * detection.height_px + truth.width_px * truth.height_px - both);
}

/// The objects of an image at one threshold, some already found.
class Board {
 public:
  Board(const std::vector<LabelledBox>& truths, double min_iou)
      : truths_(truths), found_(truths.size(), false), min_iou_(min_iou) {}

  Outcome take_best(const vision::Detection& detection) {
    const std::ptrdiff_t counted = best(detection, false);
    if (counted >= 0) {
      found_[static_cast<std::size_t>(counted)] = true;
      return Outcome::kCorrect;
    }
    return best(detection, true) >= 0 ? Outcome::kIgnored : Outcome::kWrong;
  }

 private:
  /// The free object, difficult or not, that overlaps most; -1 when none does enough. Of equal ones the later.
  std::ptrdiff_t best(const vision::Detection& detection, bool difficult) const {
    std::ptrdiff_t index = -1;
    double best_iou = min_iou_;
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      if (truths_[i].difficult != difficult || found_[i]) continue;
      const double iou = overlap(detection, truths_[i]);
      if (iou < best_iou) continue;
      best_iou = iou;
      index = static_cast<std::ptrdiff_t>(i);
    }
    return index;
  }

  const std::vector<LabelledBox>& truths_;
  std::vector<bool> found_;
  double min_iou_;
};

/// Judges the 100 best detections of one image against its objects, best first.
std::vector<JudgedDetection> judge(const std::vector<vision::Detection>& detections,
                                   const std::vector<LabelledBox>& truths) {
  const std::vector<vision::Detection> sorted = best_first(detections);
  std::vector<JudgedDetection> judged(sorted.size());
  for (std::size_t t = 0; t < kIouThresholds.size(); ++t) {
    Board board(truths, kIouThresholds[t]);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      judged[i].score = sorted[i].score;
      judged[i].outcome[t] = board.take_best(sorted[i]);
    }
  }
  return judged;
}

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
    const auto reached = std::ranges::lower_bound(running.recall, step / double(kRecallSteps));
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
    std::ranges::copy_if(image.truths, std::back_inserter(truths), looked_at);
    std::ranges::copy_if(image.detections, std::back_inserter(detections), looked_at);
    accuracy.truths +=
        static_cast<std::size_t>(std::ranges::count_if(truths, [](const LabelledBox& box) { return !box.difficult; }));
    const std::vector<JudgedDetection> here = judge(detections, truths);
    judged.insert(judged.end(), here.begin(), here.end());
  }
  std::ranges::stable_sort(judged, std::ranges::greater{}, &JudgedDetection::score);
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
  const auto best = std::ranges::max_element(curve, {}, &OperatingPoint::f1);
  return best == curve.end() ? std::nullopt : std::optional(*best);
}

std::optional<OperatingPoint> highest_threshold_with_recall(const std::vector<OperatingPoint>& curve, double recall) {
  const auto reached =
      std::ranges::find_if(curve, [recall](const OperatingPoint& point) { return point.recall >= recall; });
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

AccuracyReport evaluate_detector(const std::vector<EvaluatedImage>& images, const GroupOf& group_of) {
  std::set<std::string> names, groups;
  for (const EvaluatedImage& image : images) {
    for (const LabelledBox& box : image.truths) {
      if (box.difficult) continue;
      names.insert(box.class_name);
      if (const std::string group = group_of(box.class_name); !group.empty()) groups.insert(group);
    }
  }
  AccuracyReport accuracy;
  for (const std::string& name : names) {
    const auto [found, added] = accuracy.classes.emplace(
        name, evaluate_boxes(images, [&name](const std::string& other) { return other == name; }));
    accuracy.ap50 += found->second.ap50() / static_cast<double>(names.size());
    accuracy.ap50_95 += found->second.ap50_95() / static_cast<double>(names.size());
  }
  for (const std::string& group : groups) {
    accuracy.groups.emplace(group,
                            evaluate_boxes(images, [&](const std::string& name) { return group_of(name) == group; }));
  }
  if (const auto person = accuracy.classes.find("person"); person != accuracy.classes.end()) {
    accuracy.person = person->second;
  }
  return accuracy;
}

}  // namespace rtd::eval
