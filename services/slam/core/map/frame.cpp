// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/frame.hpp"

#include <algorithm>
#include <cmath>

#include "common/msg/frame_size.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

std::size_t count_usable(const msg::FeatureFrame& message) {
  const auto end = message.features.begin() + message.count;
  return static_cast<std::size_t>(std::count_if(message.features.begin(), end, [](const msg::Feature& feature) {
    return (feature.flags & msg::kFeatureRemoved) == 0 && usable(feature);
  }));
}

}  // namespace

FrameRaster raster_of(const msg::FeatureFrame& message) {
  const int scale = msg::feature_scale(message.width, message.height);
  const double first_px = 0.5 * (scale - 1);
  const auto& [fx, fy, cx, cy] = message.intrinsics;
  return {{fx * scale, fy * scale, cx * scale + first_px, cy * scale + first_px},
          scale * static_cast<int>(message.width),
          scale * static_cast<int>(message.height),
          scale};
}

bool usable(const msg::Feature& feature) {
  constexpr float kFarOutside_px = 1e6F;  // no lens puts a pixel there
  return std::abs(feature.u_px) < kFarOutside_px && std::abs(feature.v_px) < kFarOutside_px &&
         std::isfinite(feature.angle_rad) && std::isfinite(feature.depth_m) && feature.depth_m >= 0 &&
         feature.static_probability >= 0 && feature.static_probability <= 1 && feature.octave < kOctaves;
}

Eigen::Vector3d Frame::unproject(std::size_t feature) const {
  return features[feature].depth_m * normalized(feature).homogeneous();
}

std::vector<Eigen::Vector3d> Frame::unproject_all() const {
  std::vector<Eigen::Vector3d> points_camera;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (features[i].depth_m > 0) points_camera.push_back(unproject(i));
  }
  return points_camera;
}

FrameInput make_frame(const msg::FeatureFrame& message, const SensorConfig& config, const ShutterMotion& motion) {
  FrameInput input;
  if (!msg::is_frame_size(message.width, message.height) || message.count > msg::kMaxFeatures) {
    input.error = "image size or feature count out of range";
    return input;
  }
  if (!msg::is_camera(message.intrinsics, message.width, message.height)) {
    input.error = "intrinsics are zero, not finite or not those of a camera of this image size";
    return input;
  }
  if (!msg::is_sensor_time(message.readout_s)) {
    input.error = "readout time is not finite or beyond 0.1 s";
    return input;
  }
  auto frame = std::make_shared<Frame>();
  frame->seq = message.seq;
  frame->stamp_ns = message.stamp_ns;
  const FrameRaster raster = raster_of(message);
  frame->camera = raster.camera;
  if (config.disparity_px_m > 0) frame->camera.disparity_px_m = config.disparity_px_m;
  frame->width_px = raster.width_px;
  frame->height_px = raster.height_px;
  frame->readout_s = motion.readout_s;
  frame->features.reserve(count_usable(message));  // exactly: keyframes keep their features
  for (std::uint32_t i = 0; i < message.count; ++i) {
    msg::Feature feature = message.features[i];
    if (raster.scale != 1) {
      feature.u_px = raster.from_image(feature.u_px);
      feature.v_px = raster.from_image(feature.v_px);
    }
    if ((feature.flags & msg::kFeatureRemoved) != 0) {
      ++input.removed;
    } else if (!usable(feature)) {
      ++input.invalid;
    } else {
      if (feature.depth_m > config.max_depth_m) feature.depth_m = 0;
      if (motion.readout_s != 0) feature = undo_rolling_shutter(feature, frame->camera, frame->height_px, motion);
      frame->features.push_back(feature);
    }
  }
  frame->grid = vision::FeatureGrid(frame->features, frame->width_px, frame->height_px);
  input.frame = std::move(frame);
  return input;
}

double row_time(double v_px, int height_px) {
  return v_px / height_px - 0.5;
}

Eigen::Vector3d drift_of(const Eigen::Vector3d& p_camera, const geometry::Vector6d& velocity_per_s) {
  return velocity_per_s.head<3>() + velocity_per_s.tail<3>().cross(p_camera);
}

msg::Feature undo_rolling_shutter(const msg::Feature& feature, const vision::RgbdProjection& camera, int height_px,
                                  const ShutterMotion& motion) {
  constexpr double kMinDepth_m = 0.05;
  const double shift_s = row_time(feature.v_px, height_px) * motion.readout_s;
  const bool deep = feature.depth_m > 0;
  const Eigen::Vector3d ray((feature.u_px - camera.cx) / camera.fx, (feature.v_px - camera.cy) / camera.fy, 1);
  geometry::Vector6d velocity = motion.velocity_per_s;
  if (!deep) velocity.head<3>().setZero();
  const Eigen::Vector3d p = deep ? Eigen::Vector3d(feature.depth_m * ray) : ray;
  const Eigen::Vector3d q = p + shift_s * drift_of(p, velocity);
  if (!(q.z() > kMinDepth_m)) return feature;
  msg::Feature moved = feature;
  moved.u_px = static_cast<float>(camera.fx * q.x() / q.z() + camera.cx);
  moved.v_px = static_cast<float>(camera.fy * q.y() / q.z() + camera.cy);
  if (deep) moved.depth_m = static_cast<float>(q.z());
  return moved;
}

}  // namespace rtd::slam
