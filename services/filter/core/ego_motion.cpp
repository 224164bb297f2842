// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/ego_motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/vision/pose_optimizer.hpp"
#include "services/filter/core/rigid_ransac.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kNearAgeNs = 100'000'000;
constexpr std::int64_t kOldAgeNs = 500'000'000;
constexpr double kKeypointSigmaPx = 0.7;  // at octave 0
constexpr double kRefineWindowPx = 8.0;

double octave_scale(int octave) { return std::pow(1.2, octave); }

vision::RgbdProjection projection_of(const geometry::CameraModel& camera) {
  const auto& p = camera.parameters();
  return {p.fx, p.fy, p.cx, p.cy};
}

/// Every n-th match, so that not more than `limit` remain and all of the image is still represented.
std::vector<const FeatureMatch*> thin_out(const std::vector<const FeatureMatch*>& matches, std::size_t limit) {
  if (matches.size() <= limit) return matches;
  std::vector<const FeatureMatch*> kept;
  for (std::size_t i = 0; i < limit; ++i) kept.push_back(matches[i * matches.size() / limit]);
  return kept;
}

/// One robust pose from chosen matches.
class PoseSolver {
 public:
  PoseSolver(const EgoMotionInput& input, const EgoMotionConfig& config, const geometry::DepthNoise& noise)
      : input_(input), config_(config), noise_(noise) {}

  vision::PoseOptimizerResult solve(const std::vector<const FeatureMatch*>& all, const Eigen::Isometry3d& T_start) const {
    const auto matches = thin_out(all, static_cast<std::size_t>(config_.max_observations));
    const auto observations = to_observations(matches);
    const auto projection = projection_of(input_.current.camera);
    vision::PoseOptimizerOptions options;
    options.min_inliers = config_.min_inliers;
    options.rounds = 3;
    vision::PoseOptimizerResult result = vision::optimize_pose(projection, observations, T_start, options);
    if (result.success && result.inliers >= config_.min_inlier_share * static_cast<double>(matches.size())) return result;
    const auto start = rigid_ransac(to_pairs(matches), config_.ransac_iterations, noise_);
    if (!start) return result;
    vision::PoseOptimizerResult other = vision::optimize_pose(projection, observations, *start, options);
    return other.success && (!result.success || other.inliers > result.inliers) ? other : result;
  }

 private:
  const msg::Feature& feature(const FeatureMatch& match) const { return input_.current.features[match.current]; }

  std::vector<vision::PoseObservation> to_observations(const std::vector<const FeatureMatch*>& matches) const {
    std::vector<vision::PoseObservation> observations;
    for (const FeatureMatch* match : matches) {
      const msg::Feature& f = feature(*match);
      observations.push_back({match->p_world, {{f.u_px, f.v_px}, f.depth_m}, octave_scale(f.octave), 1.0});
    }
    return observations;
  }
  std::vector<PointPair> to_pairs(const std::vector<const FeatureMatch*>& matches) const {
    std::vector<PointPair> pairs;
    for (const FeatureMatch* match : matches) {
      const msg::Feature& f = feature(*match);
      if (f.depth_m > 0) pairs.push_back({input_.current.camera.unproject({f.u_px, f.v_px}, f.depth_m), match->p_world});
    }
    return pairs;
  }

  const EgoMotionInput& input_;
  const EgoMotionConfig& config_;
  const geometry::DepthNoise& noise_;
};

std::vector<const FeatureMatch*> usable(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input,
                                        const std::vector<char>& moving_cluster) {
  std::vector<const FeatureMatch*> kept;
  for (const FeatureMatch& match : matches) {
    const int cluster = input.cluster_of[match.current];
    if (!match.reference_static || input.excluded[match.current] != 0) continue;
    if (cluster >= 0 && moving_cluster[static_cast<std::size_t>(cluster)] != 0) continue;
    kept.push_back(&match);
  }
  return kept;
}

/// Matches with the previous view and, where that is another one, with the view 0.1 s ago.
std::vector<FeatureMatch> match_recent(const EgoMotionInput& input, const EgoMotionConfig& config) {
  const View& previous = input.views.newest();
  const View& near = input.views.of_age(input.stamp_ns, kNearAgeNs);
  std::vector<FeatureMatch> matches;
  for (double window_px = config.window_px; matches.size() < 2 * static_cast<std::size_t>(config.min_inliers); window_px *= 2) {
    matches = match_by_projection(previous, input.current, input.T_world_camera_predicted, window_px, config);
    if (window_px > 4 * config.window_px) break;
  }
  if (near.seq != previous.seq) {
    const auto more = match_by_projection(near, input.current, input.T_world_camera_predicted, 1.5 * config.window_px, config);
    matches.insert(matches.end(), more.begin(), more.end());
  }
  return matches;
}

}  // namespace

double displacement_chi2(const FeatureMatch& match, const SearchableFeatures& current, const Eigen::Isometry3d& T_camera_world) {
  constexpr double kBehindCamera = 1e6;
  const msg::Feature& feature = current.features[match.current];
  const Eigen::Vector3d p_camera = T_camera_world * match.p_world;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return kBehindCamera;
  const Eigen::Vector2d error = current.camera.project(p_camera) - Eigen::Vector2d(feature.u_px, feature.v_px);
  const double sigma_px = kKeypointSigmaPx * octave_scale(feature.octave);
  return error.squaredNorm() / (2 * sigma_px * sigma_px);  // both ends of the match are uncertain
}

ClusterVotes count_votes(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input, std::size_t clusters,
                         const Eigen::Isometry3d& T_world_camera, const GeometryConfig& geometry) {
  ClusterVotes votes{std::vector<int>(clusters, 0), std::vector<int>(clusters, 0)};
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  for (const FeatureMatch& match : matches) {
    const int cluster = input.cluster_of[match.current];
    if (cluster < 0) continue;
    const double chi2 = displacement_chi2(match, input.current, T_camera_world);
    if (chi2 < geometry.max_static_chi2) ++votes.resting[static_cast<std::size_t>(cluster)];
    if (chi2 > geometry.min_moving_chi2) ++votes.moving[static_cast<std::size_t>(cluster)];
  }
  return votes;
}

EgoMotion estimate_ego_motion(const EgoMotionInput& input, const EgoMotionConfig& config, const GeometryConfig& geometry) {
  EgoMotion ego;
  ego.T_world_camera = input.T_world_camera_predicted;
  ego.matches = match_recent(input, config);
  const PoseSolver solver(input, config, geometry.noise);
  const auto clusters = static_cast<std::size_t>(1 + *std::max_element(input.cluster_of.begin(), input.cluster_of.end()));
  std::vector<char> moving_cluster(clusters, 0);

  const auto first = solver.solve(usable(ego.matches, input, moving_cluster), input.T_world_camera_predicted);
  if (!first.success) return ego;
  const ClusterVotes votes = count_votes(ego.matches, input, clusters, first.T_world_camera, geometry);
  for (std::size_t cluster = 0; cluster < clusters; ++cluster) moving_cluster[cluster] = votes.moves(cluster, geometry) ? 1 : 0;

  const View& old = input.views.of_age(input.stamp_ns, kOldAgeNs);
  const auto old_matches = match_by_projection(old, input.current, first.T_world_camera, kRefineWindowPx, config);
  std::vector<const FeatureMatch*> all = usable(ego.matches, input, moving_cluster);
  const std::vector<const FeatureMatch*> more = usable(old_matches, input, moving_cluster);
  all.insert(all.end(), more.begin(), more.end());
  const auto refined = solver.solve(all, first.T_world_camera);
  if (!refined.success) return ego;
  ego.reliable = true;
  ego.T_world_camera = refined.T_world_camera;
  ego.inliers = refined.inliers;
  return ego;
}

}  // namespace rtd::filter
