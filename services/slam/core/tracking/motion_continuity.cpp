// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/msg/stamps.hpp"
#include "services/slam/core/tracking/tracker.hpp"

/// Whether a camera can have moved as a pose says, and where it is expected.
namespace rtd::slam {
namespace {

/// Of the landmarks that should be seen, or of the features if fewer, so many must agree on a pose that the camera can
/// hardly have reached. Wrong matches agree by chance to 0.17, true ones to 0.3.
constexpr double kMinShareOfJump = 0.25;

}  // namespace

/// Since the last tracked frame; 0 without one.
double Tracker::since_last_s(const Frame& frame) const {
  constexpr double kNanosecondsPerSecond = 1e9;
  if (last_.frame == nullptr) return 0;
  return static_cast<double>(msg::minus_ns(frame.stamp_ns, last_.frame->stamp_ns)) / kNanosecondsPerSecond;
}

/// Whether IMU or wheels expect the camera there.
bool Tracker::is_expected(const Frame& frame, const Eigen::Isometry3d& T_world_camera) const {
  return follows_prior(frame) &&
         pose_distance2(*expected_, {T_world_camera, geometry::Matrix6d::Zero()}) < kMaxPoseDistance2;
}

/// A camera keeps moving as it did: inertia decides what landmarks on one side of the image leave open.
/// docs/theory/tracking.md Eq. (20).
std::optional<vision::PositionPrior> Tracker::position_since_last(const Frame& frame) const {
  const double gap_s = since_last_s(frame);
  const bool in_time = gap_s > 0 && gap_s <= kMaxPredictionGap_s;
  const double inertia_m_s2 = config_.tracker.inertia_m_s2;
  if (inertia_m_s2 == 0 || !in_time || !motion_ || !msg::has_pose(state_) || follows_prior(frame)) return std::nullopt;
  constexpr double kOfLastPoses_m = 0.005;
  return vision::PositionPrior{predict(frame).T_world_camera.translation(),
                               kOfLastPoses_m + inertia_m_s2 * gap_s * gap_s};
}

/// Found by the reference keyframe's descriptors alone, or by hardly any landmark of the last frame, the camera may as
/// well have been carried away to a place that looks alike.
bool Tracker::believable(const Frame& frame, const PoseGuess& start, const LocalMapTracking& tracking) const {
  if (contradicts_prior(frame, tracking)) return false;
  if (!config_.techniques.place_recognition) return true;
  if (continues_motion(frame, tracking.guess.T_world_camera)) return true;
  if (!start.guided) return is_convincing(frame, tracking, config_.place);
  if (!msg::has_pose(state_)) {
    return start.inliers >= config_.tracker.min_inliers ||
           agrees_widely(frame, tracking, config_.place.min_found_ratio);
  }
  return start.inliers >= config_.tracker.min_inliers && agrees_widely(frame, tracking, kMinShareOfJump);
}

/// Whether the camera got there as it moved before, or from rest as a hand may move it: no other place looks alike from
/// just where it is expected.
bool Tracker::continues_motion(const Frame& frame, const Eigen::Isometry3d& T_world_camera) const {
  constexpr double kMaxOff_m = 0.1, kMaxOff_rad = 0.2;  // however long the gap
  constexpr double kMaxSpeed_m_s = 2, kMaxSpeed_rad_s = 5;
  if (is_expected(frame, T_world_camera)) return true;
  const double gap_s = since_last_s(frame);
  if (!msg::has_pose(state_) || gap_s <= 0 || gap_s > kMaxPredictionGap_s) return false;
  const Eigen::Isometry3d T_last_camera = last_.T_world_camera.inverse() * T_world_camera;
  const auto within = [&](const Eigen::Isometry3d& T, double limit_m, double limit_rad) {
    return T.translation().norm() <= std::min(limit_m, kMaxOff_m) &&
           geometry::rotation_angle_rad(T) <= std::min(limit_rad, kMaxOff_rad);
  };
  if (within(T_last_camera, kMaxSpeed_m_s * gap_s, kMaxSpeed_rad_s * gap_s)) return true;
  if (!motion_ || !is_steady(*motion_, T_last_camera, gap_s)) return false;
  return within(off_motion(*motion_, T_last_camera, gap_s), kMaxOff_m, kMaxOff_rad);
}

/// Whether neither a hand nor a robot carries a camera from the last pose to this one, and no IMU or wheels say so.
bool Tracker::moves_impossibly(const Frame& frame, const Eigen::Isometry3d& T_world_camera) const {
  const double gap_s = since_last_s(frame);
  if (!msg::has_pose(state_) || gap_s <= 0) return false;
  if (is_expected(frame, T_world_camera)) return false;
  const Eigen::Isometry3d T_last_camera = last_.T_world_camera.inverse() * T_world_camera;
  if (T_last_camera.translation().norm() > config_.tracker.max_speed_m_s * gap_s) return true;
  if (!motion_ || gap_s > kMaxPredictionGap_s) return false;
  return off_motion(*motion_, T_last_camera, gap_s).translation().norm() >
         config_.tracker.max_acceleration_m_s2 * gap_s * gap_s;
}

}  // namespace rtd::slam
