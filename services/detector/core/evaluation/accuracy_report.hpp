// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "services/detector/core/evaluation/average_precision.hpp"

namespace rtd::detector {

/// The group (motion level) of a class; empty: of none.
using GroupOf = std::function<std::string(const std::string& class_name)>;

/// How good a detector is on a set of images.
struct AccuracyReport {
  double ap50 = 0, ap50_95 = 0;                ///< means over the classes that occur
  std::map<std::string, BoxAccuracy> classes;  ///< those that occur
  std::map<std::string, BoxAccuracy> groups;   ///< all classes of a group taken as one: the filter asks no more
  BoxAccuracy person;                          ///< also when nobody occurs (then without values)
};

AccuracyReport evaluate_detector(const std::vector<EvaluatedImage>& images, const GroupOf& group_of);

}  // namespace rtd::detector
