// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/ego_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"
#include "common/vision/reprojection.hpp"
#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

constexpr double kMinImageShare = 0.25;  ///< if less of the image agrees on a motion: no pose

struct Best {
  std::uint32_t index = 0;
  int hamming = std::numeric_limits<int>::max(), second = std::numeric_limits<int>::max();
};

Best nearest_descriptor(const msg::Feature& wanted, const SearchableFeatures& current,
                        const vision::SearchWindow& window) {
  Best best;
  current.grid.for_each(window, [&](std::uint32_t index) {
    const int hamming = vision::hamming_distance(wanted.descriptor, current.features[index].descriptor);
    if (hamming < best.hamming) {
      best.second = best.hamming;
      best.hamming = hamming;
      best.index = index;
    } else if (hamming < best.second) {
      best.second = hamming;
    }
  });
  return best;
}

/// Of several matches of one current feature, the best is kept.
std::vector<FeatureMatch> make_unique(std::vector<FeatureMatch> matches, std::size_t feature_count) {
  std::vector<int> best(feature_count, std::numeric_limits<int>::max());
  for (const FeatureMatch& match : matches) best[match.current] = std::min(best[match.current], match.hamming);
  std::erase_if(matches, [&](const FeatureMatch& match) {
    if (match.hamming != best[match.current]) return true;
    best[match.current] = -1;  // a second match at the same distance is dropped
    return false;
  });
  return matches;
}

constexpr double kFarM = 6, kFarSigmaPerM = 0.05, kLeastFarSigmaPx = 0.1;  // from 4 m on: 1 / z is known to 0.05 / m
constexpr std::int64_t kNearAgeNs = 100'000'000;
constexpr std::int64_t kOldAgeNs = 500'000'000;
constexpr double kRefineWindowRad = 0.015;
constexpr std::int64_t kMinSlowAgeNs = 400'000'000;
constexpr double kMinSlowImageShare = 0.4;               // if less agrees, the pose is wrong, not the surroundings
constexpr double kSlowWindowRad = 0.03, kSlowMS = 0.05;  // the window grows by what such a mover covers

/// Whether a feature without a depth is beyond the sensor's range, and not in the shadow of a person.
bool is_far(const View& view, const msg::Feature& feature) {
  constexpr float kNearM = 3;
  constexpr int kAroundCells = 4;
  const GridShape& shape = view.grid.shape;
  const int column = static_cast<int>(feature.u_px) / shape.cell_px,
            row = static_cast<int>(feature.v_px) / shape.cell_px;
  const int last_row = std::min(shape.rows - 1, row + kAroundCells);
  const int last_column = std::min(shape.columns - 1, column + kAroundCells);
  for (int r = std::max(0, row - kAroundCells); r <= last_row; ++r) {
    for (int c = std::max(0, column - kAroundCells); c <= last_column; ++c) {
      const float depth_m = view.grid.depth_m[static_cast<std::size_t>(shape.index(c, r))];
      if (depth_m > 0 && depth_m < kNearM) return false;
    }
  }
  return true;
}

/// Matches with the view 0.1 s ago and, when they are few, with the previous one.
std::vector<FeatureMatch> match_recent(const EgoMotionInput& input, const View& near, const EgoMotionConfig& config) {
  const View& previous = input.views.newest();
  const Eigen::Isometry3d& T_world_camera = input.T_world_camera_predicted;
  const std::size_t enough = 4 * static_cast<std::size_t>(config.min_inliers);
  const auto window_px = [&](const View& view) {
    return search_window_px(input.current.camera, msg::minus_ns(input.stamp_ns, view.stamp_ns), config);
  };
  std::vector<FeatureMatch> matches =
      match_by_projection(near, input.current, T_world_camera, window_px(near), config, 0, Unmeasured::kFar);
  if (matches.size() < enough && previous.seq != near.seq) {
    const auto more = match_by_projection(previous, input.current, T_world_camera, window_px(previous), config);
    matches.insert(matches.end(), more.begin(), more.end());
  }
  if (matches.size() < enough) {  // the prediction is off: look farther
    matches = match_by_projection(previous, input.current, T_world_camera, 3 * window_px(previous), config);
  }
  return matches;
}

/// Whether two views are turned against each other as the gyroscope says. If not, a pose of slam was wrong in between.
bool turned_alike(const KnownRotation& by_one, const KnownRotation& by_other) {
  constexpr double kSigmas = 3;
  if (!by_one || !by_other) return true;
  const double variance = (by_one->covariance + by_other->covariance).trace() / 3;
  const Eigen::Vector3d off_rad = geometry::so3_log(by_one->R_world_camera.transpose() * by_other->R_world_camera);
  return off_rad.squaredNorm() < kSigmas * kSigmas * variance;
}

std::vector<PointSighting> to_sightings(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input) {
  std::vector<PointSighting> sightings;
  sightings.reserve(matches.size());
  for (const FeatureMatch& match : matches) sightings.push_back(to_sighting(match, input));
  return sightings;
}

/// The matches that may take part in the pose, thinned out evenly to at most `limit`. `moving_cluster`: per cluster, 1
/// = not used.
std::vector<FeatureMatch> usable(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input,
                                 const std::vector<char>& moving_cluster, std::size_t limit) {
  std::vector<FeatureMatch> kept;
  for (const FeatureMatch& match : matches) {
    const int cluster = input.cluster_of[match.current];
    if (!match.reference_static || input.excluded[match.current] != 0) continue;
    if (cluster >= 0 && moving_cluster[static_cast<std::size_t>(cluster)] != 0) continue;
    kept.push_back(match);
  }
  return vision::thin_out(std::move(kept), limit);
}

/// Votes of the features found again in a view up to 1.5 s old: what moves at a few cm/s stays within the noise over
/// 0.1 s, but not over a second. The camera's motion since that view is estimated again, by the agreement of the image,
/// so that neither drift of the quick pose nor a map that follows the mover appears as motion of everything else. Empty
/// where no view is old enough (0.4 s) or the image does not agree. docs/theory/dynamic_points.md section 3.
FeatureVotes count_slow_votes(const EgoMotionInput& input, const Eigen::Isometry3d& T_world_camera,
                              const EgoMotionConfig& config) {
  const View& old = input.views.long_ago(input.stamp_ns, input.look_back_ns);
  const std::int64_t age_ns = msg::minus_ns(input.stamp_ns, old.stamp_ns);
  if (age_ns < kMinSlowAgeNs) return {};
  const double reach_m = kSlowMS * 1e-9 * static_cast<double>(age_ns);
  const auto matches = match_by_projection(old, input.current, T_world_camera,
                                           kSlowWindowRad * input.current.camera.parameters().fx, config, reach_m);
  const std::vector<char> none_moves(input.clusters.cells.size(), 0);
  const auto limit = static_cast<std::size_t>(config.max_observations);
  const auto sightings = to_sightings(usable(matches, input, none_moves, limit), input);
  const StaticConsensus consensus =
      find_static_consensus(sightings, input.current.camera, T_world_camera, config, rotation_since(old, input));
  if (consensus.image_share < kMinSlowImageShare) return {};
  return count_votes(to_sightings(matches, input), input.current.camera, consensus.T_world_camera, input.clusters);
}

}  // namespace

void Gyroscope::add(inertial::ImuSample sample) {
  sample.stamp_ns = msg::plus_ns(sample.stamp_ns, msg::ns_of(config_.time_offset_s));
  samples_.add(sample);
}

std::optional<inertial::CameraTurn> Gyroscope::turn(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto motion = samples_.integrate(from_ns, to_ns, {}, {config_.noise_rad_s_rthz, 0});
  if (!motion) return std::nullopt;
  const Eigen::Matrix3d bias = std::pow(config_.bias_rad_s, 2) * Eigen::Matrix3d::Identity();
  return inertial::turn_of_camera(*motion, config_.R_camera_imu, {bias, config_.scale_error});
}

KnownRotation rotation_since(const View& view, const EgoMotionInput& input) {
  if (input.gyroscope == nullptr) return std::nullopt;
  const auto turn = input.gyroscope->turn(view.stamp_ns, input.stamp_ns);
  if (!turn) return std::nullopt;
  return vision::RotationPrior{view.T_world_camera.linear() * turn->R_earlier_later, turn->covariance};
}

PointSighting to_sighting(const FeatureMatch& match, const EgoMotionInput& input) {
  const msg::Feature& f = input.current.features[match.current];
  const double sigma_px = displacement_sigma_px(f.octave, input.current.camera);
  if (match.far_sigma_px > 0) return {match.p_world, {f.u_px, f.v_px}, 0, std::hypot(sigma_px, match.far_sigma_px), -1};
  return {match.p_world, {f.u_px, f.v_px}, f.depth_m, sigma_px, input.cluster_of[match.current]};
}

double search_window_px(const geometry::CameraModel& camera, std::int64_t age_ns, const EgoMotionConfig& config) {
  constexpr double kShortest_s = 0.1, kMost_rad = 0.2;  // even the last frame is known no better
  const double age_s = std::max(kShortest_s, 1e-9 * static_cast<double>(age_ns));
  return camera.parameters().fx * std::min(kMost_rad, config.window_rad_s * age_s);
}

std::vector<FeatureMatch> match_by_projection(const View& reference, const SearchableFeatures& current,
                                              const Eigen::Isometry3d& T_world_camera, double window_px,
                                              const EgoMotionConfig& config, double reach_m, Unmeasured unmeasured) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  const double fx = current.camera.parameters().fx, reach_px_m = reach_m * fx;
  const double moved_m = (T_world_camera.translation() - reference.T_world_camera.translation()).norm();
  const double far_sigma_px = std::max(kLeastFarSigmaPx, kFarSigmaPerM * fx * moved_m);
  std::vector<FeatureMatch> matches;
  for (std::uint32_t i = 0; i < reference.features.size(); ++i) {
    const msg::Feature& feature = reference.features[i];
    const bool far = feature.depth_m <= 0;
    if (far && (unmeasured == Unmeasured::kLeftOut || !is_far(reference, feature))) continue;
    const Eigen::Vector3d p_world = reference.T_world_camera * current.camera.unproject({feature.u_px, feature.v_px},
                                                                                        far ? kFarM : feature.depth_m);
    const Eigen::Vector3d p_camera = T_camera_world * p_world;
    if (p_camera.z() < vision::kMinProjectionDepth_m) continue;
    const Eigen::Vector2d pixel = current.camera.project(p_camera);
    if (!current.camera.contains(pixel)) continue;
    const vision::SearchWindow window{static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                                      static_cast<float>(window_px + reach_px_m / p_camera.z()), feature.octave - 1,
                                      feature.octave + 1};
    const Best best = nearest_descriptor(feature, current, window);
    if (best.hamming > config.max_hamming || best.hamming > config.max_ratio * best.second) continue;
    const bool at_rest = (feature.flags & msg::kFeatureRemoved) == 0;
    matches.push_back({best.index, i, best.hamming, at_rest, p_world, far ? far_sigma_px : 0});
  }
  return make_unique(std::move(matches), current.features.size());
}

EgoMotion estimate_ego_motion(const EgoMotionInput& input, const EgoMotionConfig& config,
                              const GeometryConfig& geometry) {
  EgoMotion ego;
  ego.T_world_camera = input.T_world_camera_predicted;
  const geometry::CameraModel& camera = input.current.camera;
  const View& near = input.views.of_age(input.stamp_ns, kNearAgeNs);
  const std::vector<FeatureMatch> near_matches = match_recent(input, near, config);
  std::vector<FeatureMatch> near_measured = near_matches;
  std::erase_if(near_measured, [](const FeatureMatch& match) { return match.far_sigma_px > 0; });
  if (static_cast<int>(near_measured.size()) < config.min_inliers) return ego;
  const auto limit = static_cast<std::size_t>(config.max_observations);
  const std::vector<char> none_moves(input.clusters.cells.size(), 0);
  const auto recent = to_sightings(usable(near_matches, input, none_moves, limit), input);
  const KnownRotation rotation = rotation_since(near, input);
  const StaticConsensus consensus =
      find_static_consensus(recent, camera, input.T_world_camera_predicted, config, rotation);
  if (consensus.image_share < kMinImageShare) return ego;

  const auto all_near = to_sightings(near_measured, input);
  const FeatureVotes first_votes = count_votes(all_near, camera, consensus.T_world_camera, input.clusters);
  std::vector<char> moves(none_moves);
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = first_votes.cluster_moves(i, geometry) ? 1 : 0;

  const View& old = input.views.of_age(input.stamp_ns, kOldAgeNs);
  const auto old_matches = match_by_projection(old, input.current, consensus.T_world_camera,
                                               kRefineWindowRad * camera.parameters().fx, config);
  std::vector<PointSighting> sightings = to_sightings(usable(near_matches, input, moves, limit / 2), input);
  if (turned_alike(rotation, rotation_since(old, input))) {
    const std::vector<PointSighting> more = to_sightings(usable(old_matches, input, moves, limit / 2), input);
    sightings.insert(sightings.end(), more.begin(), more.end());
  }
  const RefinedPose refined = refine_pose(sightings, camera, consensus.T_world_camera, config.min_inliers, rotation);
  if (!refined.success) return ego;
  ego.reliable = true;
  ego.settled = msg::minus_ns(input.stamp_ns, near.stamp_ns) >= kMinSettledAgeNs;
  ego.T_world_camera = refined.T_world_camera;
  ego.inliers = refined.inliers;
  ego.votes = count_votes(all_near, camera, refined.T_world_camera, input.clusters);
  ego.old_votes = count_votes(to_sightings(old_matches, input), camera, refined.T_world_camera, input.clusters);
  if (input.look_back_ns > 0) ego.slow_votes = count_slow_votes(input, refined.T_world_camera, config);
  return ego;
}

}  // namespace rtd::filter
