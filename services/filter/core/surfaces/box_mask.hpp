// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/vision/detection.hpp"
#include "common/vision/person_masks.hpp"

namespace rtd::filter {

/// The pixels of one object, kept with the box in which they were found, so that they can move with it.
class BoxMask {
 public:
  BoxMask() = default;
  /// Empty when no place has the label, or when there are not as many labels as places.
  BoxMask(const vision::PersonMasks& masks, std::uint8_t label, const vision::Detection& box);

  bool empty() const { return places_.empty(); }
  /// Does the pixel of the camera's own image belong to the object, whose box is `now`? False without a mask.
  bool covers(const Eigen::Vector2d& raw_px, const vision::Detection& now) const;

 private:
  vision::Detection box_;
  int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  ///< part of the grid of labels that has this one
  std::vector<std::uint8_t> places_;                 ///< row-major; not 0 = the object
};

}  // namespace rtd::filter
