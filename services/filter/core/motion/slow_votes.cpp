// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/slow_votes.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kMinSlowAgeNs = 400'000'000;
constexpr double kSlowWindowPx = 16.0, kSlowMS = 0.05;  // the window grows by what such a mover covers

}  // namespace

FeatureVotes count_slow_votes(const EgoMotionInput& input, const Eigen::Isometry3d& T_world_camera,
                              const EgoMotionConfig& config, const GeometryConfig& geometry) {
  const View& old = input.views.long_ago(input.stamp_ns, input.look_back_ns);
  const std::int64_t age_ns = input.stamp_ns - old.stamp_ns;
  if (age_ns < kMinSlowAgeNs) return {};
  const double reach_m = kSlowMS * 1e-9 * static_cast<double>(age_ns);
  const auto matches = match_by_projection(old, input.current, T_world_camera, kSlowWindowPx, config, reach_m);
  const std::vector<char> none_moves(input.clusters.cells.size(), 0);
  const auto limit = static_cast<std::size_t>(config.max_observations);
  const auto sightings = to_sightings(usable(matches, input, none_moves, limit), input);
  const StaticConsensus consensus = find_static_consensus(sightings, input.current.camera, T_world_camera, config);
  if (consensus.image_share < config.min_image_share) return {};
  return count_votes(to_sightings(matches, input), input.current.camera, consensus.T_world_camera, input.clusters,
                     geometry);
}

}  // namespace rtd::filter
