// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"
#include "services/evaluation/core/detection/labels.hpp"

namespace rtd::eval {

/// COCO's ten overlaps at which a detection counts as correct.
inline constexpr std::array<double, 10> kIouThresholds = {0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95};

/// What is in one image, and what was found there.
struct EvaluatedImage {
  std::vector<LabelledBox> truths;
  std::vector<vision::Detection> detections;
};

/// What a confidence threshold gives, at an overlap of 0.5.
struct OperatingPoint {
  double threshold = 0, precision = 0, recall = 0, f1 = 0;
};

/// How well the boxes of one class, or of several classes taken as one, are found.
struct BoxAccuracy {
  std::size_t truths = 0, detections = 0;          ///< difficult ones and what was found of them not counted
  std::array<double, kIouThresholds.size()> ap{};  ///< average precision by overlap
  std::vector<OperatingPoint> curve;               ///< one point for each score, highest threshold first

  double ap50() const { return ap[0]; }
  double ap50_95() const;
};

/// Which classes are looked at.
using ClassFilter = std::function<bool(const std::string& class_name)>;

/// As COCO does (pycocotools, `bbox`, all areas): in every image the 100 best detections, best score first, take the
/// free box that they overlap most, if by at least the threshold. Over all images, by falling score,
///   precision(r) = max over recalls >= r,   AP = mean of precision at r = 0, 0.01 .. 1.
/// Boxes marked as difficult (which COCO has not) may be taken any number of times, and that counts neither way.
BoxAccuracy evaluate_boxes(const std::vector<EvaluatedImage>& images, const ClassFilter& belongs);

/// The point of a curve with the largest F1 = 2 P R / (P + R); the higher threshold of equal ones. Empty: no
/// detections.
std::optional<OperatingPoint> best_f1(const std::vector<OperatingPoint>& curve);
/// The highest threshold that finds at least `recall` of the objects. Empty: none does.
std::optional<OperatingPoint> highest_threshold_with_recall(const std::vector<OperatingPoint>& curve, double recall);
/// The point that a threshold stands for: everything scored at least so much. Recall 0 and precision 1 when there is
/// nothing.
OperatingPoint at_threshold(const std::vector<OperatingPoint>& curve, double threshold);

/// The group (motion level) of a class; empty: of none.
using GroupOf = std::function<std::string(const std::string& class_name)>;

/// How good a detector is on a set of images.
struct AccuracyReport {
  double ap50 = 0, ap50_95 = 0;                ///< means over the classes that occur
  std::map<std::string, BoxAccuracy> classes;  ///< those that occur
  std::map<std::string, BoxAccuracy> groups;   ///< all classes of a group taken as one: the filter needs no more
  BoxAccuracy person;                          ///< without values when there are no people
};

AccuracyReport evaluate_detector(const std::vector<EvaluatedImage>& images, const GroupOf& group_of);

}  // namespace rtd::eval
