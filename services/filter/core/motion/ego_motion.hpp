// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/inertial/preintegration.hpp"
#include "common/vision/features.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/config/motion_config.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/motion/view_store.hpp"

namespace rtd::filter {

/// Turns of the camera from the samples of an IMU. docs/theory/dynamic_points.md section 2. Not thread-safe.
class Gyroscope {
 public:
  explicit Gyroscope(const GyroscopeConfig& config) : config_(config) {}

  void add(inertial::ImuSample sample);
  /// Empty when the samples do not cover the span.
  std::optional<inertial::CameraTurn> turn(std::int64_t from_ns, std::int64_t to_ns) const;
  /// Everything older than any view is forgotten.
  void forget_before(std::int64_t stamp_ns) { samples_.forget_before(stamp_ns); }
  void clear() { samples_.clear(); }

 private:
  GyroscopeConfig config_;
  inertial::ImuStream samples_;
};

/// A feature of a reference view found again in the current frame.
struct FeatureMatch {
  std::uint32_t current = 0;    ///< index in the current features
  std::uint32_t reference = 0;  ///< index in the features of the reference view
  int hamming = 0;
  bool reference_static = true;                       ///< the reference view did not judge it dynamic
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< m, from the reference view's depth and pose
  double far_sigma_px = 0;  ///< > 0: it has no depth and counts as far; by so much that may be wrong in the image
};

/// The features of the current frame, ready to be searched.
struct SearchableFeatures {
  std::span<const msg::Feature> features;
  const vision::FeatureGrid& grid;
  const geometry::CameraModel& camera;
};

/// How far from the prediction features of a view of this age are searched for.
double search_window_px(const geometry::CameraModel& camera, std::int64_t age_ns, const EgoMotionConfig& config);

/// What becomes of the features of a view that have no depth.
enum class Unmeasured : std::uint8_t {
  kLeftOut,
  kFar,  ///< they are beyond the sensor's range: over 0.1 s they show how the camera has turned
};

/// Projects the features of `reference` into the expected current pose and takes the nearest descriptor within
/// `window_px` (plus the image of `reach_m` at its depth), if it is near enough and clearly nearer than the second.
/// Each current feature is matched at most once.
std::vector<FeatureMatch> match_by_projection(const View& reference, const SearchableFeatures& current,
                                              const Eigen::Isometry3d& T_world_camera, double window_px,
                                              const EgoMotionConfig& config, double reach_m = 0,
                                              Unmeasured unmeasured = Unmeasured::kLeftOut);

/// Input of the estimate of the camera's motion.
struct EgoMotionInput {
  SearchableFeatures current;
  const std::vector<char>& excluded;   ///< per feature, 1 = on something that may move: not used for the pose
  const std::vector<int>& cluster_of;  ///< per feature, depth cluster or -1
  const DepthClusters& clusters;
  const ViewStore& views;  ///< not empty
  std::int64_t stamp_ns;
  Eigen::Isometry3d T_world_camera_predicted;
  std::int64_t look_back_ns =
      0;  ///< also compare with a view this old, to find what moves too slowly for 0.1 s; 0 = not in this frame
  const Gyroscope* gyroscope = nullptr;  ///< none: the image alone says how the camera has turned
};

/// The rotation of the camera by the gyroscope, from that of a view on.
KnownRotation rotation_since(const View& view, const EgoMotionInput& input);

/// Where a feature was and is.
PointSighting to_sighting(const FeatureMatch& match, const EgoMotionInput& input);

/// The quick pose of the current frame and what it was found from.
struct EgoMotion {
  bool settled =
      false;  ///< found against a view at least 0.09 s old: movers could be distinguished from the camera's own motion
  bool reliable = false;  ///< otherwise the pose is only the prediction and geometry makes no statement
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  int inliers = 0;
  FeatureVotes votes;       ///< of the features found again in the view 0.1 s ago, movers included
  FeatureVotes old_votes;   ///< and in the view 0.5 s ago, near their place
  FeatureVotes slow_votes;  ///< and in one of up to 1.5 s ago; none in most frames
};

/// Slow votes are counted only so often: what is slow can wait.
inline constexpr std::int64_t kLookBackEveryNs = 100'000'000;

/// A pose found over less time may have followed a mover.
inline constexpr std::int64_t kMinSettledAgeNs = 90'000'000;

/// Pose of the current frame from what stands still: features matched with the view 0.1 s ago (one frame is too short:
/// on distant walls a shift nearly looks like a rotation, and one motion explains walls and mover), the motion that
/// most of the image agrees with, without the clusters that move as a whole against it; then refined
/// (common/vision/pose_optimizer), against older views too, so that errors do not add up. docs/theory/dynamic_points.md
/// section 2.
EgoMotion estimate_ego_motion(const EgoMotionInput& input, const EgoMotionConfig& config,
                              const GeometryConfig& geometry);

}  // namespace rtd::filter
