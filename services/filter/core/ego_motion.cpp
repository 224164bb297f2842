// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/ego_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/filter/core/static_consensus.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kNearAgeNs = 100'000'000;
constexpr std::int64_t kOldAgeNs = 500'000'000;
constexpr double kKeypointSigmaPx = 0.7;  // at octave 0
constexpr double kRefineWindowPx = 8.0;

double octave_scale(int octave) {
  return std::pow(1.2, octave);
}

PointSighting to_sighting(const FeatureMatch& match, const EgoMotionInput& input) {
  const msg::Feature& f = input.current.features[match.current];
  const double sigma_px = std::numbers::sqrt2 * kKeypointSigmaPx * octave_scale(f.octave);  // both ends are uncertain
  return {match.p_world, {f.u_px, f.v_px}, f.depth_m, sigma_px, input.cluster_of[match.current]};
}

/// The matches that may take part in the pose, every n-th of them, so that not more than `limit` remain.
std::vector<FeatureMatch> usable(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input,
                                 const std::vector<char>& moving_cluster, std::size_t limit) {
  std::vector<FeatureMatch> kept;
  for (const FeatureMatch& match : matches) {
    const int cluster = input.cluster_of[match.current];
    if (!match.reference_static || input.excluded[match.current] != 0) continue;
    if (cluster >= 0 && moving_cluster[static_cast<std::size_t>(cluster)] != 0) continue;
    kept.push_back(match);
  }
  if (kept.size() <= limit) return kept;
  std::vector<FeatureMatch> thinned;
  for (std::size_t i = 0; i < limit; ++i) thinned.push_back(kept[i * kept.size() / limit]);
  return thinned;
}

std::vector<PointSighting> to_sightings(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input) {
  std::vector<PointSighting> sightings;
  sightings.reserve(matches.size());
  for (const FeatureMatch& match : matches) sightings.push_back(to_sighting(match, input));
  return sightings;
}

/// Matches with the view 0.1 s ago and, when they are few, with the previous one.
std::vector<FeatureMatch> match_recent(const EgoMotionInput& input, const View& near, const EgoMotionConfig& config) {
  const View& previous = input.views.newest();
  const Eigen::Isometry3d& T_world_camera = input.T_world_camera_predicted;
  const std::size_t enough = 4 * static_cast<std::size_t>(config.min_inliers);
  std::vector<FeatureMatch> matches =
      match_by_projection(near, input.current, T_world_camera, config.window_px, config);
  if (matches.size() < enough && previous.seq != near.seq) {
    const auto more = match_by_projection(previous, input.current, T_world_camera, config.window_px, config);
    matches.insert(matches.end(), more.begin(), more.end());
  }
  if (matches.size() < enough) {  // the prediction is off: look farther
    matches = match_by_projection(previous, input.current, T_world_camera, 3 * config.window_px, config);
  }
  return matches;
}

}  // namespace

EgoMotion estimate_ego_motion(const EgoMotionInput& input, const EgoMotionConfig& config,
                              const GeometryConfig& geometry) {
  EgoMotion ego;
  ego.T_world_camera = input.T_world_camera_predicted;
  const geometry::CameraModel& camera = input.current.camera;
  const View& near = input.views.of_age(input.stamp_ns, kNearAgeNs);
  const std::vector<FeatureMatch> near_matches = match_recent(input, near, config);
  const auto limit = static_cast<std::size_t>(config.max_observations);
  const std::vector<char> none_moves(input.clusters.cells.size(), 0);
  const auto recent = to_sightings(usable(near_matches, input, none_moves, limit), input);
  const StaticConsensus consensus = find_static_consensus(recent, camera, input.T_world_camera_predicted, config);
  if (consensus.image_share < config.min_image_share) return ego;

  const auto all_near = to_sightings(near_matches, input);
  const FeatureVotes first_votes = count_votes(all_near, camera, consensus.T_world_camera, input.clusters, geometry);
  std::vector<char> moves(none_moves);
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = first_votes.cluster_moves(i, geometry) ? 1 : 0;

  const View& old = input.views.of_age(input.stamp_ns, kOldAgeNs);
  const auto old_matches = match_by_projection(old, input.current, consensus.T_world_camera, kRefineWindowPx, config);
  std::vector<PointSighting> sightings = to_sightings(usable(near_matches, input, moves, limit / 2), input);
  const std::vector<PointSighting> more = to_sightings(usable(old_matches, input, moves, limit / 2), input);
  sightings.insert(sightings.end(), more.begin(), more.end());
  const RefinedPose refined = refine_pose(sightings, camera, consensus.T_world_camera, config.min_inliers);
  if (!refined.success) return ego;
  ego.reliable = true;
  ego.settled = input.stamp_ns - near.stamp_ns >= kMinSettledAgeNs;
  ego.T_world_camera = refined.T_world_camera;
  ego.inliers = refined.inliers;
  ego.votes = count_votes(all_near, camera, refined.T_world_camera, input.clusters, geometry);
  return ego;
}

}  // namespace rtd::filter
