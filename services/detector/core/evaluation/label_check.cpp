// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/evaluation/label_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rtd::detector {
namespace {

std::string describe(const LabelledBox& box) {
  return fmt::format("{} {:.1f} {:.1f} {:.1f} x {:.1f} px", box.class_name, box.x_px, box.y_px, box.width_px,
                     box.height_px);
}

/// Text formats round: the same object marked twice may differ in the last digit.
bool same(const LabelledBox& a, const LabelledBox& b) {
  constexpr double kRounding_px = 0.05;
  const auto near = [](double left, double right) { return std::abs(left - right) < kRounding_px; };
  return a.class_name == b.class_name && near(a.x_px, b.x_px) && near(a.y_px, b.y_px) && near(a.width_px, b.width_px) &&
         near(a.height_px, b.height_px);
}

LabelledBox clip(const LabelledBox& box, ImageSize image) {
  LabelledBox clipped = box;
  clipped.x_px = std::clamp(box.x_px, 0.0, double(image.width_px));
  clipped.y_px = std::clamp(box.y_px, 0.0, double(image.height_px));
  clipped.width_px = std::clamp(box.x_px + box.width_px, 0.0, double(image.width_px)) - clipped.x_px;
  clipped.height_px = std::clamp(box.y_px + box.height_px, 0.0, double(image.height_px)) - clipped.y_px;
  return clipped;
}

}  // namespace

void add_label(const LabelledBox& box, ImageSize image, const std::string& where, ImageLabels& labels) {
  const auto reject = [&](const std::string& cause) {
    labels.problems.push_back(fmt::format("{}: {}: {}", where, describe(box), cause));
  };
  const bool finite =
      std::isfinite(box.x_px) && std::isfinite(box.y_px) && std::isfinite(box.width_px) && std::isfinite(box.height_px);
  if (!finite) return reject("is not a number");
  if (box.width_px <= 0 || box.height_px <= 0) return reject("has no area");
  const LabelledBox clipped = clip(box, image);
  if (clipped.width_px <= 0 || clipped.height_px <= 0) {
    return reject(fmt::format("lies outside the image of {} x {} px", image.width_px, image.height_px));
  }
  const bool repeated = std::any_of(labels.boxes.begin(), labels.boxes.end(),
                                    [&](const LabelledBox& earlier) { return same(earlier, clipped); });
  if (repeated) return reject("is there twice, counted once");
  labels.boxes.push_back(clipped);
}

}  // namespace rtd::detector
