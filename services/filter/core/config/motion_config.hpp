// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/geometry/camera_model.hpp"

namespace rtd::filter {

/// Quick pose estimate.
struct EgoMotionConfig {
  /// Half side of the search window: the camera's turn may differ so much from the prediction.
  double window_rad_s = 0.57;
  int max_hamming = 64;        ///< largest descriptor distance of a match
  double max_ratio = 0.85;     ///< best to second best distance
  int max_observations = 350;  ///< per pose optimisation
  int min_inliers = 20;
  int max_proposals = 6;  ///< surfaces that propose a motion

  void bind(auto& binder) {
    binder.field("min_inliers", min_inliers, {6, 1000}, "fewer: no pose, geometry makes no statement");
  }
};

/// A gyroscope fixed to the camera, as its data sheet says.
struct GyroscopeConfig {
  double noise_rad_s_rthz = 2e-4;
  double bias_rad_s = 0.01;
  double scale_error = 0.01;
  double time_offset_s = 0;
  Eigen::Matrix3d R_camera_imu = Eigen::Matrix3d::Identity();  ///< from the IMU's axes to the optical frame

  void bind(auto& binder) {
    binder.field("gyro_rad_s_rthz", noise_rad_s_rthz, {1e-7, 1.0}, "noise density of the gyroscope, rad/s per root Hz");
    binder.field("gyro_bias_rad_s", bias_rad_s, {1e-6, 1.0}, "standard deviation of its bias, which stays unknown");
    binder.field("gyro_scale_error", scale_error, {0.0, 0.5},
                 "standard deviation of what it and its clock are off, share of a turn");
    binder.field("time_offset_s", time_offset_s, {-0.5, 0.5}, "added to the stamps of the samples");
  }
};

/// Multi-view checks; docs/theory/dynamic_points.md Eq. (3)-(5).
struct GeometryConfig {
  geometry::DepthNoise noise;
  double tau_floor_m = 0.08;
  double tau_sigmas = 5.0;
  double max_view_angle_deg = 30.0;
  double max_baseline_m = 0.8;
  int max_views = 6;  ///< reference views per frame
  double max_unsettled_share = 0.05;
  double min_resting_ratio = 5.0;  ///< this many times more features at their place than displaced: at rest
  int min_moving_features = 12;
  int min_creeping_features = 6;
  double memory_s = 1.0;
  double loose_memory_s = 0.17;  ///< memory of a moving part of a resting surface

  void bind(auto& binder) {
    binder.field("noise_offset_m", noise.offset_m, {0.0, 0.1}, "standard deviation of a depth: this");
    binder.field("noise_factor_per_m", noise.factor_per_m, {0.0, 0.1}, "plus this times depth squared");
    binder.field("tau_floor_m", tau_floor_m, {0.01, 2.0}, "smallest significant depth difference (the paper: 0.4 m)");
    binder.field("tau_sigmas", tau_sigmas, {1.0, 50.0}, "plus this many standard deviations of the difference");
    binder.field("max_view_angle_deg", max_view_angle_deg, {1.0, 90.0},
                 "no statement at a larger angle between the two viewing rays (paper section III-A)");
    binder.field("max_baseline_m", max_baseline_m, {0.01, 10.0},
                 "keyframes from farther away saw the other side of things and are not used");
    binder.field("max_unsettled_share", max_unsettled_share, {0.0, 1.0},
                 "if recent views see through a larger share of a surface, it has not come to rest");
    binder.field("min_moving_features", min_moving_features, {1, 2048},
                 "displaced features before a surface is judged by them");
    binder.field("min_creeping_features", min_creeping_features, {1, 2048}, "the same over a second, for slow movers");
    binder.field("memory_s", memory_s, {0.0, 2.55},
                 "for how long a dynamic surface is remembered after the last evidence");
  }
};

}  // namespace rtd::filter
