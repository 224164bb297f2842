// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/box_mask.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::filter {
namespace {

int place_of(double px) {
  return static_cast<int>(std::floor((px + 0.5) / vision::kMaskStepPx));
}

}  // namespace

BoxMask::BoxMask(const vision::PersonMasks& masks, std::uint8_t label, const vision::Detection& box) : box_(box) {
  const bool complete =
      masks.columns > 0 && masks.rows > 0 &&
      masks.labels.size() == static_cast<std::size_t>(masks.columns) * static_cast<std::size_t>(masks.rows);
  if (!complete || label == 0) return;
  int right = 0, bottom = 0;
  left_ = masks.columns;
  top_ = masks.rows;
  for (int row = 0; row < masks.rows; ++row) {
    for (int column = 0; column < masks.columns; ++column) {
      if (masks.at(column, row) != label) continue;
      left_ = std::min(left_, column);
      top_ = std::min(top_, row);
      right = std::max(right, column + 1);
      bottom = std::max(bottom, row + 1);
    }
  }
  if (right <= left_) return;
  columns_ = right - left_;
  rows_ = bottom - top_;
  places_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = top_; row < bottom; ++row) {
    for (int column = left_; column < right; ++column) places_.push_back(masks.at(column, row) == label ? 1 : 0);
  }
}

bool BoxMask::covers(const Eigen::Vector2d& raw_px, const vision::Detection& now) const {
  if (places_.empty()) return false;
  const auto then = [](double px, double now_px, double now_size, double then_px, double then_size) {
    return (px - now_px) / now_size * then_size + then_px;
  };
  const int column = place_of(then(raw_px.x(), now.x_px, now.width_px, box_.x_px, box_.width_px)) - left_;
  const int row = place_of(then(raw_px.y(), now.y_px, now.height_px, box_.y_px, box_.height_px)) - top_;
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return false;
  return places_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)] != 0;
}

}  // namespace rtd::filter
