// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/epipolar_mode.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "services/filter/core/modes/epipolar_check.hpp"

namespace rtd::filter {
namespace {

constexpr const char* kPerson = "person";

std::vector<int> cells_of_points(const PublishedInput& input, const std::vector<cv::Point2f>& raw_points) {
  std::vector<int> cells;
  cells.reserve(raw_points.size());
  for (const cv::Point2f& raw : raw_points) {
    const Eigen::Vector2d p = input.image.camera.undistort(Eigen::Vector2d(raw.x, raw.y));
    cells.push_back(input.shape.nearest_cell(p.x(), p.y()));
  }
  return cells;
}

}  // namespace

CellMask moving_masks(const PublishedInput& input, const std::vector<cv::Point2f>& moving_points, int min_points,
                      int dilate_cells) {
  const std::vector<int> points = cells_of_points(input, moving_points);
  CellMask moving(static_cast<std::size_t>(input.shape.size()), 0);
  for (const SceneObject& object : input.objects) {
    if (object.class_name != kPerson) continue;
    CellMask mask(moving.size(), 0);
    for (const int cell : object.cells) mask[static_cast<std::size_t>(cell)] = 1;
    mask = dilate(input.shape, mask, dilate_cells);
    const auto on_mask = std::count_if(points.begin(), points.end(),
                                       [&](int cell) { return mask[static_cast<std::size_t>(cell)] != 0; });
    if (on_mask <= min_points) continue;
    for (std::size_t cell = 0; cell < mask.size(); ++cell) moving[cell] = std::max(moving[cell], mask[cell]);
  }
  return moving;
}

PublishedVerdict EpipolarMode::judge(const PublishedInput& input, std::vector<msg::Feature>& features) {
  cv::Mat grey;
  cv::cvtColor(input.image.color_bgr, grey, cv::COLOR_BGR2GRAY);
  std::vector<cv::Point2f> moving_points;
  if (grey_before_.size() == grey.size()) {
    moving_points = find_moving_points(follow_corners(grey_before_, grey, config_), input.image.camera, config_);
  }
  grey_before_ = grey;
  const CellMask moving = moving_masks(input, moving_points, config_.max_still_points, dilate_cells_);
  for (msg::Feature& feature : features) {
    const bool moves = moving[static_cast<std::size_t>(input.shape.nearest_cell(feature.u_px, feature.v_px))] != 0;
    if (moves) feature.flags |= msg::kFeatureInHighMask | msg::kFeatureGeometryMoving;
    mark(feature, moves);
  }
  return {moving, false, Eigen::Isometry3d::Identity()};
}

}  // namespace rtd::filter
