// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/tracking_steps.hpp"

#include <algorithm>
#include <utility>

#include "common/msg/stamps.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "services/slam/core/tracking/matcher.hpp"
#include "services/slam/core/tracking/pose_ransac.hpp"

namespace rtd::slam {
namespace {

constexpr int kMinLandmarks = 10;  ///< of a first guess of the pose

/// A landmark in its window: ORB-SLAM2's largest distance and ratio. In the whole image others are as similar by
/// chance.
constexpr MatchRules kInWindow{100, 0.8, RotationCheck::kOff}, kAnywhere{60, 0.8, RotationCheck::kOn};

/// A landmark as the world point of a feature.
Association associate(std::uint32_t feature, const LocalLandmark& landmark) {
  return {feature,          landmark.id,          landmark.position,  landmark.static_probability,
          landmark.witness, landmark.in_question, landmark.unmeasured};
}

vision::PoseObservation make_observation(const Frame& frame, const Association& association,
                                         const Eigen::Vector3d& camera) {
  const msg::Feature& feature = frame.features[association.feature];
  const double by_depth_px = association.unmeasured.sigma_px(camera, frame.camera.fx);
  return {association.p_world, frame.measurement(association.feature),
          std::hypot(sigma_px(feature.octave), by_depth_px),
          static_weight(feature, association.static_probability, association.in_question)};
}

constexpr int kFewestWitnesses = 8;  ///< two points on one edge must not outweigh an image
/// A pose with which fewer of the witnesses agree is compared with one of which hardly anything else decides.
constexpr double kMostOfThem = 0.6, kHardlyAny = 0.01, kClearlyMore = 1.25;

/// What a pose is found from, besides observations with their weights.
struct RgbdPoseProblem {
  const vision::RgbdProjection& camera;
  const std::vector<Association>& associations;
  const Eigen::Isometry3d& T_world_camera_initial;
  const vision::PoseOptimizerOptions& options;
};

/// How many agree, and how many there are.
std::pair<int, int> count_witnesses(const std::vector<Association>& associations, const std::vector<char>& inlier) {
  std::pair<int, int> counts{0, 0};
  for (std::size_t i = 0; i < associations.size(); ++i) {
    if (!associations[i].witness) continue;
    counts.first += inlier[i] != 0 ? 1 : 0;
    ++counts.second;
  }
  return counts;
}

void weaken_others(const std::vector<Association>& associations, double factor,
                   std::vector<vision::PoseObservation>& observations) {
  for (std::size_t i = 0; i < associations.size(); ++i) {
    if (!associations[i].witness) observations[i].weight *= factor;
  }
}

/// How much a landmark counts for where the camera is: its weight, less with the square of its distance.
double influence_of(const vision::PoseObservation& observation, const Eigen::Vector3d& camera) {
  constexpr double kNearest_m = 0.5;
  const double distance_m = std::max(kNearest_m, (observation.p_world - camera).norm());
  return observation.weight / (distance_m * distance_m);
}

/// Witnesses carry the pose: what is on probation has at most a share of their influence, however much of it there is.
/// Few witnesses leave it more. Returns the factor of its weights.
double weigh_probation(const std::vector<Association>& associations, const WitnessConfig& config,
                       const Eigen::Vector3d& camera, std::vector<vision::PoseObservation>& observations) {
  int witnesses = 0;
  double of_witnesses = 0, of_others = 0;
  for (std::size_t i = 0; i < associations.size(); ++i) {
    witnesses += associations[i].witness ? 1 : 0;
    (associations[i].witness ? of_witnesses : of_others) += influence_of(observations[i], camera);
  }
  constexpr double kManyWitnesses = 120;
  if (!config.used || witnesses < kFewestWitnesses) return 1;
  const double most = of_witnesses * config.probation_share * (1 + kManyWitnesses / witnesses);
  if (of_others <= most) return 1;
  weaken_others(associations, most / of_others, observations);
  return most / of_others;
}

/// Where most of the witnesses contradict a pose, that by which clearly more of them agree, hardly anything else being
/// asked, if there is one.
std::optional<vision::PoseOptimizerResult> prefer_witnesses(const vision::PoseOptimizerResult& found,
                                                            const RgbdPoseProblem& problem,
                                                            std::vector<vision::PoseObservation> observations) {
  const auto [agreeing, witnesses] = count_witnesses(problem.associations, found.inlier);
  if (witnesses < kFewestWitnesses || agreeing >= kMostOfThem * witnesses) return std::nullopt;
  weaken_others(problem.associations, kHardlyAny, observations);
  auto by_them = vision::optimize_pose(problem.camera, observations, problem.T_world_camera_initial, problem.options);
  const bool better =
      by_them.success && count_witnesses(problem.associations, by_them.inlier).first > kClearlyMore * agreeing;
  if (!better) return std::nullopt;
  return by_them;
}

PoseGuess optimize(const Frame& frame, const std::vector<Association>& associations,
                   const Eigen::Isometry3d& T_world_camera_initial, const TrackingContext& context) {
  const std::int64_t start_ns = context.now_ns();
  std::vector<vision::PoseObservation> observations;
  observations.reserve(associations.size());
  for (const Association& association : associations)
    observations.push_back(make_observation(frame, association, T_world_camera_initial.translation()));
  double probation_weight =
      weigh_probation(associations, context.config.witness, T_world_camera_initial.translation(), observations);
  vision::PoseOptimizerOptions options;
  if (context.config.techniques.adaptive_kernel) options.kernel = vision::RobustKernel::kAdaptive;
  options.rotation = context.rotation;
  options.position = context.position;
  auto optimized = vision::optimize_pose(frame.camera, observations, T_world_camera_initial, options);
  if (context.config.witness.used) {
    const RgbdPoseProblem problem{frame.camera, associations, T_world_camera_initial, options};
    if (auto by_witnesses = prefer_witnesses(optimized, problem, std::move(observations))) {
      optimized = std::move(*by_witnesses);
      probation_weight *= kHardlyAny;
    }
  }
  PoseGuess guess;
  guess.success = optimized.success;
  guess.probation_weight = probation_weight;
  guess.T_world_camera = optimized.T_world_camera;
  guess.covariance = optimized.covariance;
  guess.image_covariance = optimized.image_covariance;
  guess.optimizer_ns = context.now_ns() - start_ns;
  guess.landmarks.assign(frame.features.size(), kNoLandmark);
  for (std::size_t i = 0; i < associations.size(); ++i) {
    if (optimized.inlier[i] == 0) continue;
    ++guess.points;
    if (associations[i].landmark == kNoLandmark) continue;
    guess.landmarks[associations[i].feature] = associations[i].landmark;
    ++guess.inliers;
    guess.witnesses += associations[i].witness ? 1 : 0;
  }
  return guess;
}

/// Landmarks of the last frame, and its close features without one at the depth that was measured there.
std::vector<Association> points_of(const TrackedFrame& last, const LocalMap& map, const TrackingContext& context) {
  std::vector<Association> points;
  points.reserve(last.landmarks.size());
  std::vector<LandmarkId> known(last.landmarks.size(), kNoLandmark);
  for (std::uint32_t i = 0; i < last.landmarks.size(); ++i) {
    if (last.landmarks[i] == kNoLandmark) continue;
    const LocalLandmark* landmark = map.find_landmark(last.landmarks[i]);
    if (landmark == nullptr) continue;
    known[i] = landmark->id;
    points.push_back(associate(i, *landmark));
  }
  for (const std::uint32_t i : select_close_features(*last.frame, known, context.config.sensor.close_depth_m)) {
    points.push_back(
        {i, kNoLandmark, last.T_world_camera * last.frame->unproject(i), last.frame->features[i].static_probability});
  }
  return points;
}

/// How far from where it was predicted a landmark is searched for, at the finest octave: the longer the gap, the less
/// is known of the motion. At 30 Hz about ORB-SLAM2's 15 px.
double search_radius_px(const Frame& frame, const TrackedFrame& last, const TrackerConfig& config) {
  constexpr double kLeast_px = 10, kMost_rad = 0.2;
  const double gap_s = msg::minus_s(frame.stamp_ns, last.frame->stamp_ns);
  const double turned_rad = std::min(config.motion_turn_rad_s * gap_s, kMost_rad);
  return std::max(kLeast_px, frame.camera.fx * turned_rad);
}

/// Octaves to search: moving forward makes things larger (coarser octaves show the same patch), backward smaller.
void set_octaves(vision::SearchWindow& window, int octave, double forward_m) {
  constexpr double kClearMotion_m = 0.08;
  window.min_octave = forward_m < -kClearMotion_m ? 0 : (forward_m > kClearMotion_m ? octave : octave - 1);
  window.max_octave = forward_m < -kClearMotion_m ? octave : (forward_m > kClearMotion_m ? kOctaves : octave + 1);
}

std::vector<SearchPoint> predict_points(const Frame& frame, const TrackedFrame& last,
                                        const std::vector<Association>& points, const Eigen::Isometry3d& T_world_camera,
                                        double radius_px) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  const double forward_m = (last.T_world_camera.inverse() * T_world_camera).translation().z();
  std::vector<SearchPoint> search;
  search.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto projection = project(frame, T_camera_world, points[i].p_world);
    if (!projection) continue;
    const msg::Feature& feature = last.frame->features[points[i].feature];
    SearchPoint point;
    point.window.u_px = static_cast<float>(projection->pixel.x());
    point.window.v_px = static_cast<float>(projection->pixel.y());
    point.window.radius_px = static_cast<float>(radius_px * sigma_px(feature.octave));
    set_octaves(point.window, feature.octave, forward_m);
    point.inverse_depth_per_m = static_cast<float>(1.0 / projection->z_m);
    point.descriptor = &feature.descriptor;
    point.angle_rad = feature.angle_rad;
    point.tag = i;
    search.push_back(point);
  }
  return search;
}

/// Where these points of the last frame are seen now.
PoseGuess track_points(const Frame& frame, const TrackedFrame& last, const std::vector<Association>& points,
                       const ExpectedPose& expected, const TrackingContext& context) {
  const TrackerConfig& config = context.config.tracker;
  const MatchRules rules{100, 1.0, RotationCheck::kOn};
  const double radius_px = expected.radius_px.value_or(search_radius_px(frame, last, config));
  std::vector<Match> matches;
  for (const double widening : {1.0, 2.0}) {
    const auto search = predict_points(frame, last, points, expected.T_world_camera, widening * radius_px);
    matches = match_projected(frame, search, {}, rules);
    if (static_cast<int>(matches.size()) >= config.min_motion_matches) break;
  }
  if (static_cast<int>(matches.size()) < config.min_motion_matches) return {};
  std::vector<Association> associations;
  associations.reserve(matches.size());
  for (const Match& match : matches) {
    associations.push_back(points[match.tag]);
    associations.back().feature = match.feature;
  }
  return optimize(frame, associations, expected.T_world_camera, context);
}

}  // namespace

PoseGuess track_last_frame(const Frame& frame, const TrackedFrame& last, const LocalMap& map,
                           const ExpectedPose& expected, const TrackingContext& context) {
  PoseGuess guess = track_points(frame, last, points_of(last, map, context), expected, context);
  guess.success = guess.success && guess.inliers >= kMinLandmarks;
  return guess;
}

PoseGuess track_motion(const Frame& frame, const TrackedFrame& last, const LocalMap& map, const ExpectedPose& expected,
                       const TrackingContext& context) {
  constexpr double kFar_m = 6;  // of a centimetre of movement, a wall at 4 or 12 m shows the same within a pixel
  std::vector<Association> points = points_of(last, map, context);
  for (std::uint32_t i = 0; i < last.frame->features.size(); ++i) {
    if (last.frame->features[i].depth_m > 0 || last.landmarks[i] != kNoLandmark) continue;
    points.push_back({i, kNoLandmark, last.T_world_camera * (kFar_m * last.frame->normalized(i).homogeneous()),
                      last.frame->features[i].static_probability});
  }
  return track_points(frame, last, points, expected, context);
}

PoseGuess track_keyframe(const Frame& frame, const LocalKeyframe& keyframe, const LocalMap& map,
                         const TrackingContext& context) {
  constexpr int kMinMatches = 15, kMinInliers = 10;
  std::vector<std::uint32_t> features;
  for (std::uint32_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (keyframe.landmarks[i] != kNoLandmark) features.push_back(i);
  }
  const auto matches = match_by_descriptor(frame, *keyframe.frame, features, kAnywhere);
  if (static_cast<int>(matches.size()) < kMinMatches) return {};
  std::vector<Association> associations;
  std::vector<vision::PoseObservation> observations;
  for (const Match& match : matches) {
    const LocalLandmark& landmark = *map.find_landmark(keyframe.landmarks[match.tag]);
    associations.push_back(associate(match.feature, landmark));
    observations.push_back(make_observation(frame, associations.back(), keyframe.T_world_camera.translation()));
  }
  PoseRansacOptions options;
  options.seed = frame.seq;
  const auto coarse = estimate_pose_ransac(frame.camera, observations, options);
  PoseGuess guess =
      optimize(frame, associations, coarse.success ? coarse.T_world_camera : keyframe.T_world_camera, context);
  guess.guided = false;
  guess.success = guess.success && guess.inliers >= kMinInliers;
  return guess;
}

PoseGuess track_around(const Frame& frame, const TrackedFrame& last, const LocalMap& map, const ExpectedPose& expected,
                       const TrackingContext& context) {
  const double radius_px = expected.radius_px.value_or(search_radius_px(frame, last, context.config.tracker));
  const Eigen::Isometry3d T_camera_world = expected.T_world_camera.inverse();
  std::vector<SearchPoint> search;
  search.reserve(map.landmarks.size());
  for (std::uint32_t i = 0; i < map.landmarks.size(); ++i) {
    const LocalLandmark& landmark = map.landmarks[i];
    const auto view =
        predict_view(frame, expected.T_world_camera, T_camera_world,
                     {landmark.position, landmark.normal, landmark.min_distance_m, landmark.max_distance_m});
    if (view) search.push_back(make_search_point(*view, radius_px, landmark.descriptor, i));
  }
  std::vector<Association> associations;
  for (const Match& match : match_projected(frame, search, {}, kInWindow)) {
    associations.push_back(associate(match.feature, map.landmarks[match.tag]));
  }
  if (static_cast<int>(associations.size()) < context.config.tracker.min_motion_matches) return {};
  PoseGuess guess = optimize(frame, associations, expected.T_world_camera, context);
  guess.success = guess.success && guess.inliers >= kMinLandmarks;
  return guess;
}

LocalMapTracking track_local_map(const Frame& frame, const LocalMap& map, const PoseGuess& guess,
                                 const TrackingContext& context) {
  const SlamConfig& config = context.config;
  constexpr double kStraightView = 0.998;  // 3.6 degrees
  constexpr double kStraightRadius_px = 2.5, kObliqueRadius_px = 4.0;
  LocalMapTracking result;
  std::vector<LandmarkId> known;
  std::vector<Association> associations;
  std::vector<char> taken(frame.features.size(), 0);
  known.reserve(frame.features.size());
  associations.reserve(frame.features.size());
  for (std::uint32_t i = 0; i < guess.landmarks.size(); ++i) {
    const LocalLandmark* landmark = guess.landmarks[i] == kNoLandmark ? nullptr : map.find_landmark(guess.landmarks[i]);
    if (landmark == nullptr) continue;
    taken[i] = 1;
    known.push_back(landmark->id);
    associations.push_back(associate(i, *landmark));
  }
  result.visible = known;
  std::sort(known.begin(), known.end());

  const Eigen::Isometry3d T_camera_world = guess.T_world_camera.inverse();
  std::vector<SearchPoint> search;
  search.reserve(map.landmarks.size());
  result.visible.reserve(map.landmarks.size());
  for (std::uint32_t i = 0; i < map.landmarks.size(); ++i) {
    const LocalLandmark& landmark = map.landmarks[i];
    if (std::binary_search(known.begin(), known.end(), landmark.id)) continue;
    const auto view =
        predict_view(frame, guess.T_world_camera, T_camera_world,
                     {landmark.position, landmark.normal, landmark.min_distance_m, landmark.max_distance_m});
    if (!view) continue;
    result.visible.push_back(landmark.id);
    const double radius_px = view->view_cosine > kStraightView ? kStraightRadius_px : kObliqueRadius_px;
    search.push_back(make_search_point(*view, config.tracker.local_radius_px * radius_px, landmark.descriptor, i));
  }
  for (const Match& match : match_projected(frame, search, taken, kInWindow)) {
    const LocalLandmark& landmark = map.landmarks[match.tag];
    associations.push_back(associate(match.feature, landmark));
  }
  result.guess = optimize(frame, associations, guess.T_world_camera, context);
  for (const Association& association : associations) {
    if (result.guess.landmarks[association.feature] == kNoLandmark) result.rejected.push_back(association);
  }
  return result;
}

std::optional<LocalMapTracking> track_place(const Frame& frame, const LocalMap& place, const TrackingContext& context) {
  const PoseGuess coarse = track_keyframe(frame, place.keyframes.front(), place, context);
  return coarse.success ? track_place_from(frame, place, coarse, context) : std::nullopt;
}

std::optional<LocalMapTracking> track_place_from(const Frame& frame, const LocalMap& place, const PoseGuess& start,
                                                 const TrackingContext& context) {
  const LocalMapTracking tracking = track_local_map(frame, place, start, context);
  if (!tracking.guess.success) return std::nullopt;
  return track_local_map(frame, place, tracking.guess, context);
}

}  // namespace rtd::slam
