// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/evaluation/accuracy_report.hpp"

#include <set>

namespace rtd::detector {

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

}  // namespace rtd::detector
