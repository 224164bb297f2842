// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <unordered_map>

#include "common/msg/tracking.hpp"
#include "services/slam/core/keyframe_policy.hpp"
#include "services/slam/core/mapper.hpp"
#include "services/slam/core/motion_prediction.hpp"
#include "services/slam/core/tracking_steps.hpp"

namespace rtd::slam {

/// What tracking says of one frame.
struct TrackOutcome {
  msg::TrackingState state = msg::TrackingState::kInitializing;
  TrackedFrame tracked;  ///< in state kPredicted the pose only
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  int inliers = 0;
  std::array<float, msg::kSlamStages> stage_ms{};
};

/// Follows the camera through the map: motion model, else reference keyframe; then local map. Owns no map, sees it in
/// snapshots only. docs/theory/tracking.md. Not thread-safe.
class Tracker {
 public:
  Tracker(const SlamConfig& config, Clock now_ns) : config_(config), now_ns_(std::move(now_ns)) {}

  /// Whether a first keyframe can be made of this frame.
  bool can_initialize(const Frame& frame) const;
  /// The frame is the first keyframe, at the origin of the world.
  TrackOutcome initialize(FramePtr frame, KeyframeId first);
  /// Tracks one frame. A failure leaves the last tracked frame as it was.
  TrackOutcome track(FramePtr frame, const LocalMap& map);
  /// The source started again: no motion can be assumed between the last frame and the next.
  void forget_motion();
  /// Between the last two tracked frames; empty when they were too far apart.
  const std::optional<CameraMotion>& motion() const { return motion_; }

  /// Whether the frame just tracked should become a keyframe, and what the mapper then needs.
  KeyframeSituation keyframe_situation(const LocalMap& map, bool mapper_idle) const;
  KeyframeProposal propose_keyframe();

 private:
  TrackingContext context() const { return {config_, now_ns_, statistics_}; }
  void adopt(const LocalMap& map);
  Eigen::Isometry3d predict(const Frame& frame) const;
  PoseGuess find_pose(const Frame& frame, const LocalMap& map);
  PoseGuess recover(const Frame& frame, const LocalMap& map);
  bool acceptable(const PoseGuess& guess) const;
  void accept(TrackOutcome& outcome, FramePtr frame, const LocalMap& map, const LocalMapTracking& tracking);
  void reject(TrackOutcome& outcome, const Frame& frame, const PoseGuess& weak);
  std::optional<PredictedPose> hold(const Frame& frame) const;
  void count(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking);

  SlamConfig config_;
  Clock now_ns_;
  msg::TrackingState state_ = msg::TrackingState::kInitializing;
  TrackedFrame last_;
  std::optional<CameraMotion> motion_;  ///< at the last tracked frame, whose pose the map may have moved since
  int inliers_ = 0;
  int frames_since_keyframe_ = 0;
  int failed_frames_ = 0;
  std::size_t next_recovery_ = 0;
  StatisticsById statistics_;
};

/// The keyframe of the window that sees most of these landmarks; kNoKeyframe when none does.
KeyframeId vote_reference(const LocalMap& map, const std::vector<LandmarkId>& landmarks);

}  // namespace rtd::slam
