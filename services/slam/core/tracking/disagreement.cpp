// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/disagreement.hpp"

#include <optional>

#include "services/slam/core/tracking/pose_ransac.hpp"

namespace rtd::slam {
namespace {

constexpr int kFewest = 8;  ///< landmarks that make a motion
constexpr std::size_t kMostMotions = 3;
constexpr double kLeastMotion_m = 0.01;

Disagreeing compare(const PoseEvidence& evidence, const Association& association, const Eigen::Vector3d& p_camera) {
  const msg::Feature& feature = evidence.frame->features[association.feature];
  const vision::RgbdMeasurement measured = evidence.frame->measurement(association.feature);
  const Eigen::Vector3d residual = vision::rgbd_residual(evidence.frame->camera, p_camera, measured);
  const Eigen::Vector2d seen_px(feature.u_raw_px, feature.v_raw_px);
  return {seen_px, seen_px + residual.head<2>() / evidence.raster_scale};
}

vision::PoseObservation observe(const PoseEvidence& evidence, const Association& association) {
  const msg::Feature& feature = evidence.frame->features[association.feature];
  return {association.p_world, evidence.frame->measurement(association.feature), sigma_px(feature.octave)};
}

/// A motion that many of these landmarks have in common, with their places among them.
struct Group {
  CommonMotion motion;
  std::vector<std::size_t> members;
};

/// Seen from the landmarks that move alike, the camera has another pose than seen from those that rest.
std::optional<Group> find_group(const PoseEvidence& evidence,
                                const std::vector<vision::PoseObservation>& observations) {
  PoseRansacOptions options;
  options.seed = evidence.frame->seq;
  options.min_inliers = options.min_with_depth = kFewest;
  const vision::RgbdProjection& camera = evidence.frame->camera;
  const PoseRansacResult coarse = estimate_pose_ransac(camera, observations, options);
  if (!coarse.success) return std::nullopt;
  Group group;
  std::vector<vision::PoseObservation> alike;  // the others would pull the pose to themselves
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!agrees(camera, observations[i], coarse.T_world_camera.inverse(), options.max_error_px)) continue;
    group.members.push_back(i);
    alike.push_back(observations[i]);
  }
  const auto fine = vision::optimize_pose(camera, alike, coarse.T_world_camera);
  if (!fine.success || alike.size() < kFewest) return std::nullopt;
  for (const vision::PoseObservation& observation : alike)
    group.motion.center_m += observation.p_world / static_cast<double>(alike.size());
  const Eigen::Isometry3d T_then_now = evidence.T_world_camera * fine.T_world_camera.inverse();
  group.motion.landmarks = static_cast<int>(alike.size());
  group.motion.moved_m = T_then_now * group.motion.center_m - group.motion.center_m;
  return group;
}

}  // namespace

Disagreement explain(const PoseEvidence& evidence) {
  Disagreement found;
  if (evidence.frame == nullptr) return found;
  const Eigen::Isometry3d T_camera_world = evidence.T_world_camera.inverse();
  std::vector<vision::PoseObservation> observations;
  std::vector<std::size_t> places;  // of the observations in found.landmarks
  for (const Association& association : evidence.rejected) {
    const Eigen::Vector3d p_camera = T_camera_world * association.p_world;
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    places.push_back(found.landmarks.size());
    found.landmarks.push_back(compare(evidence, association, p_camera));
    observations.push_back(observe(evidence, association));
  }
  for (std::size_t turn = 0; turn < kMostMotions; ++turn) {
    const std::optional<Group> group = find_group(evidence, observations);
    if (!group) break;
    const bool moves = group->motion.moved_m.norm() > kLeastMotion_m;
    for (auto member = group->members.rbegin(); member != group->members.rend(); ++member) {
      const auto at = static_cast<std::ptrdiff_t>(*member);
      if (moves) found.landmarks[places[*member]].motion = static_cast<int>(found.motions.size());
      observations.erase(observations.begin() + at);
      places.erase(places.begin() + at);
    }
    if (moves) found.motions.push_back(group->motion);
  }
  return found;
}

}  // namespace rtd::slam
