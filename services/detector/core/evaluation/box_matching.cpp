// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/evaluation/box_matching.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::detector {
namespace {

constexpr std::size_t kMaxDetections = 100;  // of an image, as COCO takes

std::vector<vision::Detection> best_first(std::vector<vision::Detection> detections) {
  std::erase_if(detections, [](const vision::Detection& detection) { return !std::isfinite(detection.score); });
  std::stable_sort(detections.begin(), detections.end(),
                   [](const vision::Detection& a, const vision::Detection& b) { return a.score > b.score; });
  if (detections.size() > kMaxDetections) detections.resize(kMaxDetections);
  return detections;
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

}  // namespace

double overlap(const vision::Detection& detection, const LabelledBox& truth) {
  const double width_px = std::min<double>(detection.x_px + detection.width_px, truth.x_px + truth.width_px) -
                          std::max<double>(detection.x_px, truth.x_px);
  const double height_px = std::min<double>(detection.y_px + detection.height_px, truth.y_px + truth.height_px) -
                           std::max<double>(detection.y_px, truth.y_px);
  if (!(width_px > 0 && height_px > 0)) return 0;
  const double both = width_px * height_px;
  return both / (double(detection.width_px) * detection.height_px + truth.width_px * truth.height_px - both);
}

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

}  // namespace rtd::detector
