// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/feature_votes.hpp"

namespace rtd::filter {
namespace {

constexpr double kMinMovingShare = 0.6;    ///< of its features displaced: it moves
constexpr double kMinCreepingShare = 0.7;  ///< of its features displaced over a second: it moves
constexpr double kMaxStaticChi2 = 6.0;     ///< squared normalised displacement up to which a feature is at its place
constexpr double kMinMovingChi2 = 16.0;    ///< ... and from which it has moved

}  // namespace

bool FeatureVotes::cluster_moves(std::size_t cluster, const GeometryConfig& config) const {
  if (cluster >= moving.size()) return false;
  const int cast = resting[cluster] + moving[cluster];
  return moving[cluster] >= config.min_moving_features && moving[cluster] >= kMinMovingShare * cast;
}

bool FeatureVotes::cluster_rests(std::size_t cluster, const GeometryConfig& config) const {
  return cluster < resting.size() && resting[cluster] >= config.min_moving_features &&
         resting[cluster] >= config.min_resting_ratio * moving[cluster];
}

bool FeatureVotes::cluster_creeps(std::size_t cluster, const GeometryConfig& config) const {
  if (cluster >= moving.size()) return false;
  const int cast = resting[cluster] + moving[cluster];
  return moving[cluster] >= config.min_creeping_features && moving[cluster] >= kMinCreepingShare * cast;
}

FeatureVotes count_votes(const std::vector<PointSighting>& sightings, const geometry::CameraModel& camera,
                         const Eigen::Isometry3d& T_world_camera, const DepthClusters& clusters) {
  FeatureVotes votes{{}, std::vector<int>(clusters.cells.size(), 0), std::vector<int>(clusters.cells.size(), 0)};
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  for (const PointSighting& sighting : sightings) {
    const auto shift_px = displacement_px(sighting, camera, T_camera_world);
    if (!shift_px) continue;
    const int cell = clusters.shape.nearest_cell(sighting.pixel.x(), sighting.pixel.y());
    votes.shifts.push_back({cell, static_cast<float>(shift_px->x()), static_cast<float>(shift_px->y())});
    const double chi2 = shift_px->squaredNorm() / (sighting.sigma_px * sighting.sigma_px);
    const bool moving = chi2 > kMinMovingChi2;
    if (!moving && chi2 >= kMaxStaticChi2) continue;
    votes.votes.push_back({cell, moving});
    if (sighting.cluster >= 0) ++(moving ? votes.moving : votes.resting)[static_cast<std::size_t>(sighting.cluster)];
  }
  return votes;
}

VotesByCell by_cell(const FeatureVotes& votes, std::size_t cells) {
  VotesByCell counted{std::vector<int>(cells, 0), std::vector<int>(cells, 0)};
  for (const FeatureVote& vote : votes.votes)
    ++(vote.moving ? counted.moving : counted.resting)[static_cast<std::size_t>(vote.cell)];
  return counted;
}

FeatureVotes without_votes_on(const std::vector<std::uint8_t>& cells, FeatureVotes votes,
                              const DepthClusters& clusters) {
  std::erase_if(votes.votes, [&](const FeatureVote& vote) {
    const auto cell = static_cast<std::size_t>(vote.cell);
    if (cells[cell] == 0) return false;
    if (clusters.label[cell] >= 0)
      --(vote.moving ? votes.moving : votes.resting)[static_cast<std::size_t>(clusters.label[cell])];
    return true;
  });
  return votes;
}

}  // namespace rtd::filter
