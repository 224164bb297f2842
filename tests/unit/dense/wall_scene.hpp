// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>

#include "common/geometry/camera_model.hpp"
#include "common/msg/tracking.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/dense/core/dense_config.hpp"
#include "services/dense/core/depth_view.hpp"

namespace rtd::dense::test {

/// A wall across the viewing axis and a person-sized block before it, seen by a small camera without distortion.
class WallScene {
 public:
  static constexpr int kWidth = 160, kHeight = 120;
  static constexpr double kWallM = 3.0, kBlockM = 1.5, kScaleM = 0.0002;
  static inline const geometry::CameraModel kCamera{{131, 131, 79.5, 59.5, {}, kWidth, kHeight}};

  /// `noise`: times the sensor's own. `block`: its pixels, empty = none.
  explicit WallScene(double noise = 1) : noise_(noise) {}

  vision::RgbdImage render(const cv::Rect& block = {}, double wall_m = kWallM) {
    vision::RgbdImage image;
    image.seq = next_++;
    image.stamp_ns = static_cast<std::int64_t>(image.seq) * 33'333'333;
    image.camera = kCamera;
    image.depth_scale_m = kScaleM;
    image.color_bgr = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 150, 100));
    image.color_bgr(block).setTo(cv::Scalar(0, 0, 255));
    image.depth = cv::Mat(kHeight, kWidth, CV_16UC1);
    for (int row = 0; row < kHeight; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        const double true_m = block.contains({column, row}) ? kBlockM : wall_m;
        const double depth_m = true_m + noise_ * geometry::DepthNoise{}.sigma_m(true_m) * normal_(random_);
        image.depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(std::lround(depth_m / kScaleM));
      }
    }
    return image;
  }

  /// The filter's word: cells of 4 px, those of the block dynamic.
  static DynamicMask mask(const cv::Rect& block) {
    DynamicMask mask{kWidth / 4, kHeight / 4, {}};
    for (int row = 0; row < mask.rows; ++row) {
      for (int column = 0; column < mask.columns; ++column) {
        const bool on = (block & cv::Rect(4 * column, 4 * row, 4, 4)).area() > 0;
        mask.cells.push_back(on ? DynamicMask::kDynamic : DynamicMask::kStatic);
      }
    }
    return mask;
  }

  /// Every pixel is fused.
  static DenseConfig config() {
    DenseConfig config;
    config.fusion.stride_px = 1;
    config.fusion.mask_grow_cells = 1;
    return config;
  }

 private:
  double noise_;
  std::uint64_t next_ = 0;
  std::mt19937_64 random_{5};
  std::normal_distribution<double> normal_;
};

inline Eigen::Isometry3d at_origin() {
  return Eigen::Isometry3d::Identity();
}

/// Of slam, at (x_m, 0, 0).
inline msg::KeyframeEvent keyframe(std::uint32_t id, double x_m,
                                   msg::KeyframeEventKind kind = msg::KeyframeEventKind::kCreated) {
  msg::KeyframeEvent event{};
  event.keyframe_id = id;
  event.stamp_ns = std::int64_t{id} * 1'000'000'000;
  event.kind = kind;
  Eigen::Isometry3d T_world_camera = at_origin();
  T_world_camera.translation().x() = x_m;
  event.T_world_camera = msg::to_message(T_world_camera);
  return event;
}

}  // namespace rtd::dense::test
