// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/static_consensus.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "common/msg/features.hpp"
#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

constexpr int kMaxProposalSightings = 100;  ///< features per proposal

constexpr double kKeypointSigmaPx = 0.7;  // at octave 0
constexpr double kMaxChi2 = 6.0;          // 95 % of chi2 with 2 degrees of freedom

/// The share of each sighting in the vote of its tile; all votes together are 1.
std::vector<double> tile_votes(const std::vector<PointSighting>& sightings) {
  constexpr double kTilePx = 40;
  std::map<std::pair<int, int>, int> in_tile;
  const auto tile = [](const PointSighting& s) {
    return std::pair(static_cast<int>(std::floor(s.pixel.x() / kTilePx)),
                     static_cast<int>(std::floor(s.pixel.y() / kTilePx)));
  };
  for (const PointSighting& s : sightings) ++in_tile[tile(s)];
  std::vector<double> votes;
  votes.reserve(sightings.size());
  for (const PointSighting& s : sightings)
    votes.push_back(1.0 / (in_tile[tile(s)] * static_cast<double>(in_tile.size())));
  return votes;
}

/// All sightings, then those of each of the clusters with most sightings.
std::vector<std::vector<PointSighting>> proposing_groups(const std::vector<PointSighting>& sightings,
                                                         const EgoMotionConfig& config) {
  std::map<int, std::vector<PointSighting>> by_cluster;
  for (const PointSighting& s : sightings) {
    if (s.cluster >= 0) by_cluster[s.cluster].push_back(s);
  }
  std::vector<std::vector<PointSighting>> groups;
  for (auto& [cluster, members] : by_cluster) {
    if (static_cast<int>(members.size()) >= config.min_inliers) groups.push_back(std::move(members));
  }
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  if (groups.size() > static_cast<std::size_t>(config.max_proposals))
    groups.resize(static_cast<std::size_t>(config.max_proposals));
  groups.insert(groups.begin(), sightings);
  return groups;
}

}  // namespace

double displacement_sigma_px(int octave, const geometry::CameraModel& camera) {
  constexpr double kOctaveScale = 1.2;  // ORB-SLAM2's, the default of OrbConfig
  const auto& p = camera.parameters();
  const int scale = msg::feature_scale(static_cast<std::uint32_t>(p.width), static_cast<std::uint32_t>(p.height));
  return std::numbers::sqrt2 * kKeypointSigmaPx * std::pow(kOctaveScale, octave) / scale;
}

std::optional<Eigen::Vector2d> displacement_px(const PointSighting& s, const geometry::CameraModel& camera,
                                               const Eigen::Isometry3d& T_camera_world) {
  const Eigen::Vector3d p_camera = T_camera_world * s.p_world;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return std::nullopt;
  return s.pixel - camera.project(p_camera);
}

double displacement_chi2(const PointSighting& s, const geometry::CameraModel& camera,
                         const Eigen::Isometry3d& T_camera_world) {
  constexpr double kBehindCamera = 1e6;
  const auto displacement = displacement_px(s, camera, T_camera_world);
  return displacement ? displacement->squaredNorm() / (s.sigma_px * s.sigma_px) : kBehindCamera;
}

RefinedPose refine_pose(const std::vector<PointSighting>& sightings, const geometry::CameraModel& camera,
                        const Eigen::Isometry3d& T_world_camera_start, int min_inliers, const KnownRotation& rotation) {
  std::vector<vision::PoseObservation> observations;
  observations.reserve(sightings.size());
  for (const PointSighting& s : sightings) observations.push_back({s.p_world, {s.pixel, s.depth_m}, s.sigma_px, 1.0});
  vision::PoseOptimizerOptions options;
  options.min_inliers = min_inliers;
  options.rounds = 3;
  options.robust_rounds = 2;
  options.rotation = rotation;
  const auto& p = camera.parameters();
  const auto result = vision::optimize_pose({p.fx, p.fy, p.cx, p.cy}, observations, T_world_camera_start, options);
  return {result.success, result.T_world_camera, result.inliers, result.covariance};
}

StaticConsensus find_static_consensus(const std::vector<PointSighting>& sightings, const geometry::CameraModel& camera,
                                      const Eigen::Isometry3d& T_world_camera_predicted, const EgoMotionConfig& config,
                                      const KnownRotation& rotation) {
  const std::vector<double> votes = tile_votes(sightings);
  StaticConsensus best{T_world_camera_predicted, 0};
  const auto propose = [&](const Eigen::Isometry3d& T_world_camera) {
    const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
    double share = 0;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      share += votes[i] * std::max(0.0, 1 - displacement_chi2(sightings[i], camera, T_camera_world) / kMaxChi2);
    }
    if (share > best.image_share) best = {T_world_camera, share};
  };
  propose(T_world_camera_predicted);
  for (const std::vector<PointSighting>& group : proposing_groups(sightings, config)) {
    const auto thinned = vision::thin_out(group, static_cast<std::size_t>(kMaxProposalSightings));
    const RefinedPose pose = refine_pose(thinned, camera, T_world_camera_predicted, config.min_inliers, rotation);
    if (pose.success) propose(pose.T_world_camera);
  }
  return best;
}

}  // namespace rtd::filter
