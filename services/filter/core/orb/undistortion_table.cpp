// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/orb/undistortion_table.hpp"

#include <algorithm>

namespace rtd::filter {
namespace {

constexpr int kStepPx = 8;

}  // namespace

void UndistortionTable::fit(const geometry::CameraModel& camera) {
  if (parameters_ == camera.parameters()) return;
  parameters_ = camera.parameters();
  identity_ = !camera.distorted();
  nodes_.clear();
  if (identity_) return;
  columns_ = parameters_.width / kStepPx + 2;
  rows_ = parameters_.height / kStepPx + 2;
  nodes_.reserve(static_cast<std::size_t>(columns_ * rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d pixel = camera.undistort({column * kStepPx, row * kStepPx});
      nodes_.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
  }
}

cv::Point2f UndistortionTable::undistort(cv::Point2f raw_pixel) const {
  if (identity_) return raw_pixel;
  const float x = std::clamp(raw_pixel.x / kStepPx, 0.0F, static_cast<float>(columns_ - 1) - 1e-3F);
  const float y = std::clamp(raw_pixel.y / kStepPx, 0.0F, static_cast<float>(rows_ - 1) - 1e-3F);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const cv::Point2f* upper = &nodes_[static_cast<std::size_t>(row * columns_ + column)];
  const cv::Point2f* lower = upper + columns_;
  return (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) + (lower[0] * (1 - fx) + lower[1] * fx) * fy;
}

}  // namespace rtd::filter
