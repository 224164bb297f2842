// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/motion_levels.hpp"

#include <stdexcept>

#include "common/io/printable.hpp"

namespace rtd::vision {
namespace {

constexpr const char* kHigh[] = {"person", "bird",       "cat",  "dog",   "horse",   "sheep",
                                 "cow",    "elephant",   "bear", "zebra", "giraffe", "bicycle",
                                 "car",    "motorcycle", "bus",  "train", "truck"};
constexpr const char* kMedium[] = {
    "chair",      "book",        "keyboard",     "mouse",      "cup",     "bottle",     "wine glass",
    "laptop",     "cell phone",  "remote",       "backpack",   "handbag", "umbrella",   "tie",
    "suitcase",   "sports ball", "potted plant", "bowl",       "vase",    "teddy bear", "scissors",
    "skateboard", "frisbee",     "hair drier",   "toothbrush", "banana",  "apple",      "orange"};
constexpr const char* kLow[] = {"tv",   "refrigerator", "couch", "bed",   "dining table", "toilet",
                                "oven", "microwave",    "sink",  "clock", "bench"};

MotionLevel parse_level(const std::string& class_name, const std::string& text) {
  if (text == "high") return MotionLevel::kHigh;
  if (text == "medium") return MotionLevel::kMedium;
  if (text == "low") return MotionLevel::kLow;
  throw std::invalid_argument("motion level of class '" + io::abridged(class_name) + "' is '" + io::abridged(text) +
                              "': use high, medium, low or none");
}

}  // namespace

MotionLevels::MotionLevels(const std::map<std::string, std::string>& overrides) {
  for (const char* name : kHigh) levels_[name] = MotionLevel::kHigh;
  for (const char* name : kMedium) levels_[name] = MotionLevel::kMedium;
  for (const char* name : kLow) levels_[name] = MotionLevel::kLow;
  for (const auto& [name, text] : overrides) {
    if (text == "none") {
      levels_.erase(name);
    } else {
      levels_[name] = parse_level(name, text);
    }
  }
}

MotionLevels MotionLevels::all_high() const {
  MotionLevels high(*this);
  for (auto& [name, level] : high.levels_) level = MotionLevel::kHigh;
  return high;
}

std::optional<MotionLevel> MotionLevels::find(const std::string& class_name) const {
  const auto found = levels_.find(class_name);
  if (found == levels_.end()) return std::nullopt;
  return found->second;
}

}  // namespace rtd::vision
