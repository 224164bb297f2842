// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/integrity/published_pose.hpp"

#include "common/msg/rotation.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::eval {
namespace {

constexpr double kUnknownTrace = 1e5;  ///< slam publishes 1e6 on the diagonal where it knows nothing

std::optional<geometry::Matrix6d> known_covariance(const std::array<double, 36>& values) {
  const geometry::Matrix6d covariance = Eigen::Map<const geometry::RowMajor6d>(values.data());
  const bool known = covariance.allFinite() && covariance.trace() > 0 && covariance.trace() < kUnknownTrace;
  return known ? std::optional(covariance) : std::nullopt;
}

}  // namespace

PublishedPose published_pose(const msg::TrackingResult& result) {
  PublishedPose pose;
  pose.stamp_ns = result.stamp_ns;
  pose.state = result.state;
  pose.map_id = result.map_id;
  if (result.state > msg::last_value(msg::TypeOf<msg::TrackingState>{})) pose.state = msg::TrackingState::kLost;
  if (!msg::has_pose(pose.state)) return pose;
  pose.T_world_camera = msg::to_isometry(result.T_world_camera);
  pose.covariance = known_covariance(result.covariance);
  if (!msg::is_rotation(result.T_world_camera.rotation_xyzw) || !pose.T_world_camera.matrix().allFinite())
    pose.state = msg::TrackingState::kLost;
  return pose;
}

geometry::Trajectory measured_poses(const std::vector<PublishedPose>& published) {
  geometry::Trajectory poses;
  for (const PublishedPose& pose : published) {
    const bool later = poses.empty() || pose.stamp_ns > poses.back().stamp_ns;
    if (later && msg::is_measured(pose.state) && pose.map_id == 0)
      poses.push_back({pose.stamp_ns, pose.T_world_camera});
  }
  return poses;
}

}  // namespace rtd::eval
