// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/lens.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

namespace rtd::camera::synthetic {
namespace {

constexpr int kSparePx = 2;  ///< beyond the outermost pixel that is looked up

/// How far the undistorted pixels of the image reach beyond it, on the wider side.
cv::Size margin_of(const cv::Mat& from_u, const cv::Mat& from_v) {
  const auto beyond = [](const cv::Mat& from, int size_px) {
    double min = 0, max = 0;
    cv::minMaxLoc(from, &min, &max);
    return std::max(0, static_cast<int>(std::ceil(std::max(-min, max - (size_px - 1))))) + kSparePx;
  };
  return {beyond(from_u, from_u.cols), beyond(from_v, from_v.rows)};
}

}  // namespace

Lens::Lens(const geometry::CameraModel& camera) : pinhole_(camera) {
  if (!camera.distorted()) return;
  geometry::CameraModel::Parameters parameters = camera.parameters();
  from_u_.create(parameters.height, parameters.width, CV_32FC1);
  from_v_.create(parameters.height, parameters.width, CV_32FC1);
  for (int row = 0; row < parameters.height; ++row) {
    for (int column = 0; column < parameters.width; ++column) {
      const Eigen::Vector2d pixel = camera.undistort({column, row});
      from_u_.at<float>(row, column) = static_cast<float>(pixel.x());
      from_v_.at<float>(row, column) = static_cast<float>(pixel.y());
    }
  }
  const cv::Size margin_px = margin_of(from_u_, from_v_);
  from_u_ += margin_px.width;
  from_v_ += margin_px.height;
  parameters.distortion = {};
  parameters.width += 2 * margin_px.width;
  parameters.height += 2 * margin_px.height;
  parameters.cx += margin_px.width;
  parameters.cy += margin_px.height;
  pinhole_ = geometry::CameraModel(parameters);
}

Rendering Lens::bent(const Rendering& rendering) const {
  if (from_u_.empty()) return rendering;
  const auto nearest = [this](const cv::Mat& image) {
    cv::Mat bent;
    cv::remap(image, bent, from_u_, from_v_, cv::INTER_NEAREST, cv::BORDER_REPLICATE);
    return bent;
  };
  Rendering bent;
  cv::remap(rendering.color_bgr, bent.color_bgr, from_u_, from_v_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  bent.inverse_depth = nearest(rendering.inverse_depth);
  bent.moving_mask = nearest(rendering.moving_mask);
  bent.material = nearest(rendering.material);
  bent.object = nearest(rendering.object);
  bent.objects = find_objects(bent.object, bent.moving_mask);
  return bent;
}

std::vector<ObjectView> find_objects(const cv::Mat& object, const cv::Mat& moving_mask) {
  std::map<int, ObjectView> found;
  for (int row = 0; row < object.rows; ++row) {
    for (int column = 0; column < object.cols; ++column) {
      const int index = object.at<std::int16_t>(row, column);
      if (index == kRoomItself) continue;
      ObjectView& view = found[index];
      view.object = index;
      view.bounds_px |= cv::Rect(column, row, 1, 1);
      ++view.visible_px;
      view.moving = view.moving || moving_mask.at<std::uint8_t>(row, column) != 0;
    }
  }
  std::vector<ObjectView> objects;
  for (const auto& [index, view] : found) objects.push_back(view);
  return objects;
}

}  // namespace rtd::camera::synthetic
