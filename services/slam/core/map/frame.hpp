// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/msg/features.hpp"
#include "common/vision/features.hpp"
#include "common/vision/reprojection.hpp"
#include "services/slam/core/config/slam_config.hpp"

namespace rtd::slam {

/// The image pyramid behind the features: octave k is 1.2^k times smaller.
inline constexpr int kOctaves = 8;
inline constexpr double kScaleFactor = 1.2;

inline constexpr std::array<double, kOctaves> kOctaveScale = [] {
  std::array<double, kOctaves> scale{};
  double value = 1;
  for (double& s : scale) {
    s = value;
    value *= kScaleFactor;
  }
  return scale;
}();

/// Standard deviation of a keypoint of this octave, px of the full image.
inline double sigma_px(int octave) {
  return kOctaveScale[static_cast<std::size_t>(octave)];
}

/// 95 % of chi2 with 2 and 3 degrees of freedom: largest squared residual of an observation without and with depth.
inline constexpr double kMaxChi2Pixel = 5.991, kMaxChi2Rgbd = 7.815;

/// Octave in which a landmark appears at `distance_m` when octave 0 shows it at `max_distance_m`.
inline int predict_octave(double max_distance_m, double distance_m) {
  const double levels = std::log(max_distance_m / distance_m) / std::log(kScaleFactor);
  return std::clamp(static_cast<int>(std::ceil(levels)), 0, kOctaves - 1);
}

/// One frame as SLAM sees it: the features that may be used, nothing of the image. Immutable once made and shared
/// between tracker and mapper; not copyable because the grid refers to the features.
struct Frame {
  Frame() = default;
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;

  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  vision::RgbdProjection camera;
  int width_px = 0, height_px = 0;
  double readout_s = 0;                ///< of a rolling shutter, undone in the features; 0 = none
  std::vector<msg::Feature> features;  ///< usable ones only; depth_m is 0 where not measured or beyond max_depth_m
  vision::FeatureGrid grid;

  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width_px && pixel.y() < height_px;
  }
  vision::RgbdMeasurement measurement(std::size_t feature) const {
    return {{features[feature].u_px, features[feature].v_px}, features[feature].depth_m};
  }
  /// Where the ray of a feature meets the plane z = 1 of the camera.
  Eigen::Vector2d normalized(std::size_t feature) const {
    const msg::Feature& f = features[feature];
    return {(f.u_px - camera.cx) / camera.fx, (f.v_px - camera.cy) / camera.fy};
  }
  /// p_camera (m) of a feature with depth.
  Eigen::Vector3d unproject(std::size_t feature) const;
  /// p_camera (m) of all features with depth.
  std::vector<Eigen::Vector3d> unproject_all() const;
};
using FramePtr = std::shared_ptr<const Frame>;

/// Whether all values of a feature are finite and in their ranges.
bool usable(const msg::Feature& feature);

/// The pixels that a frame's positions are given in: those of the image that the features were found in, which is the
/// doubled one of a small image (docs/theory/orb.md), because windows and deviations in pixels belong to them.
struct FrameRaster {
  vision::RgbdProjection camera;
  int width_px = 0, height_px = 0;
  int scale = 1;  ///< its pixels per pixel of the camera's image
  /// Position along one axis of the camera's image -> the same place here.
  float from_image(float px) const { return static_cast<float>(scale) * px + 0.5F * static_cast<float>(scale - 1); }
};
FrameRaster raster_of(const msg::FeatureFrame& message);

/// What make_frame() did with the message.
struct FrameInput {
  FramePtr frame;             ///< null when the message as a whole is unusable
  std::string error;          ///< then: why
  std::uint32_t removed = 0;  ///< features left out because the filter judged them dynamic
  std::uint32_t invalid = 0;  ///< features left out because a value is not finite or out of range
};

/// How the camera moves while an image is read out row by row, docs/theory/rolling_shutter.md.
struct ShutterMotion {
  geometry::Vector6d velocity_per_s = geometry::Vector6d::Zero();  ///< twist in the camera's frame, m/s and rad/s
  double readout_s = 0;                                            ///< from the first row to the last; 0 = all at once
};

/// Takes the usable features out of a message, each where it would be had all rows been exposed at once. Data from
/// outside: never throws for its content.
FrameInput make_frame(const msg::FeatureFrame& message, const SensorConfig& config, const ShutterMotion& motion = {});

/// Time of a row relative to the middle one, in units of the readout time. Eq. (1).
double row_time(double v_px, int height_px);

/// How fast a static point in the camera's frame drifts back when the camera's motion is undone, m/s. Eq. (2).
Eigen::Vector3d drift_of(const Eigen::Vector3d& p_camera, const geometry::Vector6d& velocity_per_s);

/// Where (and how deep) a feature would have been seen had its row been exposed together with the middle one.
/// Eq. (1), (2). A feature without depth counts as far away: only the rotation moves it.
msg::Feature undo_rolling_shutter(const msg::Feature& feature, const vision::RgbdProjection& camera, int height_px,
                                  const ShutterMotion& motion);

}  // namespace rtd::slam
