// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/undecided_surfaces.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::filter {
namespace {

constexpr int kMinOfSurface = 12, kMinOfRest = 20;  // sightings
constexpr double kMovesBeyond = 40;                 // of RelativeMotion::distance2; at rest, 5 of 100 are beyond it
constexpr double kRestsWithin = 11.3;               // 99 % of chi2 with 3 degrees of freedom
constexpr double kCarried_m_s = 0.3;                // what is carried moves as fast
constexpr double kSeenSigmas = 2;                   // and would show, when it covers so many standard deviations

/// The features seen in both views, by where they lie.
struct SharedSightings {
  std::map<int, std::vector<PointSighting>> surfaces;  ///< in question, by cluster
  std::vector<PointSighting> rest;
};

SharedSightings sightings_since(const View& view, const EgoMotionInput& input, const std::vector<char>& in_question,
                                const EgoMotionConfig& config) {
  const double window_px =  // what is carried may be twice as fast as the camera turns
      2 * search_window_px(input.current.camera, msg::minus_ns(input.stamp_ns, view.stamp_ns), config);
  SharedSightings shared;
  for (const FeatureMatch& match :
       match_by_projection(view, input.current, input.T_world_camera_predicted, window_px, config)) {
    const PointSighting sighting = to_sighting(match, input);
    if (input.excluded[match.current] != 0) continue;
    if (in_question[match.current] == 0) {
      if (match.reference_static) shared.rest.push_back(sighting);
    } else if (sighting.cluster >= 0) {
      shared.surfaces[sighting.cluster].push_back(sighting);
    }
  }
  return shared;
}

Eigen::Vector3d middle_of(const std::vector<PointSighting>& sightings) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PointSighting& sighting : sightings) sum += sighting.p_world;
  return sum / static_cast<double>(sightings.size());
}

/// How the middle of a surface has moved, by two motions of the camera.
RelativeMotion between(const RefinedPose& by_rest, const RefinedPose& by_surface, const Eigen::Vector3d& middle) {
  const Eigen::Vector3d moved = by_rest.T_world_camera * (by_surface.T_world_camera.inverse() * middle) - middle;
  Eigen::Matrix<double, 3, 6> J;  // of a point there, by the camera's pose
  J << Eigen::Matrix3d::Identity(), -geometry::skew(middle - by_rest.T_world_camera.translation());
  const Eigen::Matrix3d covariance = J * (by_rest.covariance + by_surface.covariance) * J.transpose();
  return {moved.dot(covariance.ldlt().solve(moved)), geometry::largest_sigma(covariance)};
}

/// Only what would have been seen moving is known to rest.
SurfaceVote vote(const RelativeMotion& motion, double age_s) {
  if (motion.distance2 > kMovesBeyond) return SurfaceVote::kMoves;
  const bool would_show = kCarried_m_s * age_s > kSeenSigmas * motion.sigma_m;
  return motion.distance2 < kRestsWithin && would_show ? SurfaceVote::kRests : SurfaceVote::kNone;
}

// Notes of a cell: nothing, known to rest, or in question, with the votes so far: kEven + (moves - rests).
constexpr std::uint8_t kNothing = 0, kRests = 1, kEven = 10;
constexpr int kEnoughVotes = 2;

bool is_open(std::uint8_t note) {
  return note > kRests;
}

/// Per cluster, moves - rests so far: the mean over its cells.
std::vector<int> votes_before(const CellMask& notes, const CellMask& open, const DepthClusters& clusters) {
  std::vector<int> sum(clusters.cells.size(), 0), cells(sum);
  for (std::size_t cell = 0; cell < notes.size(); ++cell) {
    const std::int32_t label = clusters.label[cell];
    if (label < 0 || open[cell] == 0 || !is_open(notes[cell])) continue;
    sum[static_cast<std::size_t>(label)] += notes[cell] - kEven;
    ++cells[static_cast<std::size_t>(label)];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (cells[i] > 0) sum[i] = static_cast<int>(std::lround(static_cast<double>(sum[i]) / cells[i]));
  }
  return sum;
}

}  // namespace

std::map<int, RelativeMotion> relative_motions(const std::map<int, std::vector<PointSighting>>& surfaces,
                                               const std::vector<PointSighting>& rest,
                                               const geometry::CameraModel& camera,
                                               const Eigen::Isometry3d& T_world_camera_start,
                                               const KnownRotation& rotation) {
  std::map<int, RelativeMotion> motions;
  const RefinedPose by_rest = refine_pose(rest, camera, T_world_camera_start, kMinOfRest, rotation);
  if (!by_rest.success) return motions;
  for (const auto& [cluster, sightings] : surfaces) {
    const RefinedPose by_surface = refine_pose(sightings, camera, T_world_camera_start, kMinOfSurface);
    if (by_surface.success) motions[cluster] = between(by_rest, by_surface, middle_of(sightings));
  }
  return motions;
}

std::vector<SurfaceVote> vote_on_surfaces(const EgoMotionInput& input, const std::vector<char>& in_question,
                                          const EgoMotionConfig& config) {
  std::vector<int> majority(input.clusters.cells.size(), 0);
  const View* last = nullptr;
  for (const std::int64_t age_ns : {300'000'000, 200'000'000, 100'000'000}) {
    const View& view = input.views.of_age(input.stamp_ns, age_ns);
    if (&view == last || msg::minus_ns(input.stamp_ns, view.stamp_ns) < kMinSettledAgeNs) continue;
    last = &view;
    const SharedSightings shared = sightings_since(view, input, in_question, config);
    for (const auto& [cluster, motion] :
         relative_motions(shared.surfaces, shared.rest, input.current.camera, input.T_world_camera_predicted,
                          rotation_since(view, input))) {
      majority[static_cast<std::size_t>(cluster)] +=
          static_cast<int>(vote(motion, msg::minus_s(input.stamp_ns, view.stamp_ns)));
    }
  }
  std::vector<SurfaceVote> votes;
  votes.reserve(majority.size());
  for (const int sum : majority) votes.push_back(static_cast<SurfaceVote>(std::clamp(sum, -1, 1)));
  return votes;
}

void SurfaceDecisions::recall(const DepthGrid& grid, const geometry::CameraModel& camera,
                              const Eigen::Isometry3d& T_current_last, double elapsed_s) {
  notes_ = memory_.recall(grid, camera, T_current_last, elapsed_s);
}

UndecidedSurfaces SurfaceDecisions::find(const Surroundings& surroundings, const CellMask& excluded,
                                         double min_step_m) {
  notes_.resize(excluded.size(), kNothing);
  CellMask asked(notes_.size(), 0), decided(asked);
  for (std::size_t cell = 0; cell < notes_.size(); ++cell) {
    asked[cell] = is_open(notes_[cell]) ? 1 : 0;
    decided[cell] = notes_[cell] == kRests ? 1 : 0;
  }
  UndecidedSurfaces undecided{surfaces_in_question(surroundings, {excluded, asked, decided}, min_step_m),
                              CellMask(notes_.size(), 0)};
  for (std::size_t cell = 0; cell < notes_.size(); ++cell) {
    if (undecided.open[cell] == 0) {
      if (is_open(notes_[cell])) notes_[cell] = kNothing;
    } else if (!is_open(notes_[cell])) {
      notes_[cell] = kEven;
    }
  }
  return undecided;
}

void SurfaceDecisions::update(UndecidedSurfaces& undecided, const DepthClusters& clusters,
                              const std::vector<SurfaceVote>& votes) {
  const std::vector<int> before = votes_before(notes_, undecided.open, clusters);
  for (std::size_t cell = 0; cell < notes_.size(); ++cell) {
    if (undecided.open[cell] == 0 || clusters.label[cell] < 0) continue;
    const auto cluster = static_cast<std::size_t>(clusters.label[cell]);
    const int sum = before[cluster] + static_cast<int>(votes[cluster]);
    notes_[cell] = static_cast<std::uint8_t>(kEven + sum);
    if (std::abs(sum) < kEnoughVotes) continue;
    undecided.open[cell] = 0;
    undecided.moving[cell] = sum > 0 ? 1 : 0;
    notes_[cell] = sum > 0 ? kNothing : kRests;
  }
}

void SurfaceDecisions::store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays) {
  memory_.store(grid, rays, notes_);
  notes_.clear();
}

void SurfaceDecisions::clear() {
  memory_.clear();
  notes_.clear();
}

}  // namespace rtd::filter
