// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <type_traits>

#include "common/msg/fields.hpp"
#include "common/msg/rotation.hpp"

namespace rtd::msg {

/// A rigid transform on the wire.
struct Transform {
  std::array<double, 3> translation_m;
  std::array<double, 4> rotation_xyzw;  ///< Hamilton unit quaternion
};
RTD_FIELDS(rtd_msgs, Transform, translation_m, rotation_xyzw)
constexpr const char* broken_rule(const Transform& T) {
  return is_rotation_or_unset(T.rotation_xyzw) ? nullptr : "rotation_xyzw";
}

enum class KeyframeEventKind : std::uint32_t { kCreated = 0, kCorrected = 1, kRemoved = 2 };
constexpr KeyframeEventKind last_value(TypeOf<KeyframeEventKind>) {
  return KeyframeEventKind::kRemoved;
}

/// "Frame 812 is keyframe 57": topic `rtd/keyframes`, from slam to the filter.
struct KeyframeEvent {
  std::uint64_t
      event_index;  ///< counts the events of one slam process from 0; TrackingResult::event_count is their number
  std::uint64_t frame_seq;
  std::int64_t stamp_ns;
  Transform T_world_camera;
  std::uint32_t keyframe_id;
  KeyframeEventKind kind;
};
RTD_FIELDS(rtd_msgs, KeyframeEvent, event_index, frame_seq, stamp_ns, T_world_camera, keyframe_id, kind)
constexpr const char* broken_rule(const KeyframeEvent& event) {
  const bool needs_pose = event.kind != KeyframeEventKind::kRemoved;
  return needs_pose && !is_rotation(event.T_world_camera.rotation_xyzw) ? "T_world_camera" : nullptr;
}

enum class TrackingState : std::uint32_t {
  kInitializing = 0,
  kOk = 1,
  kRecentlyLost = 2,
  kLost = 3,
  kRelocalizing = 4,  ///< a place was recognised; its pose is published once the next frames agree
  kPredicted = 5,     ///< nothing static in view: the last motion continues for a moment, without measurement
  kDoubtful = 6,      ///< measured, but much of what is seen contradicts the pose: something may take it along
  kOdometry = 7,      ///< measured from frame to frame: the map is not recognised, so errors add up
};

constexpr TrackingState last_value(TypeOf<TrackingState>) {
  return TrackingState::kOdometry;
}

/// For logs, diagnostics and the live line.
constexpr const char* to_string(TrackingState state) {
  constexpr const char* kNames[] = {"initializing", "ok",        "recently lost", "lost",
                                    "relocalizing", "predicted", "doubtful",      "odometry"};
  const auto place = static_cast<std::size_t>(state);
  return place < std::size(kNames) ? kNames[place] : "unknown";
}

/// Whether the pose of a result of this state was measured in its frame.
constexpr bool is_measured(TrackingState state) {
  return state == TrackingState::kOk || state == TrackingState::kDoubtful || state == TrackingState::kOdometry;
}

/// Whether a result of this state has a pose: measured or predicted.
constexpr bool has_pose(TrackingState state) {
  return is_measured(state) || state == TrackingState::kPredicted;
}

/// Stages of slam whose time travels in TrackingResult::stage_ms.
enum SlamStage : std::uint32_t {
  kStageMatch,
  kStageLocalMap,
  kStagePose,
  kStageKeyframe,
  kStageMapping,
  kStageSlamTotal,
  kStageRelocalize,  ///< trying the places that look like the frame, while tracking is lost
  kSlamStages = 8
};

/// The outcome of tracking one frame: topic `rtd/tracking`, every frame, also when tracking failed.
struct TrackingResult {
  std::uint64_t seq;
  std::int64_t stamp_ns;
  std::int64_t published_ns;          ///< copied from the RgbdFrame
  std::int64_t finished_ns;           ///< CLOCK_MONOTONIC when the pose was ready; latency = finished_ns - published_ns
  Transform T_world_camera;           ///< valid where has_pose(state); camera frame is optical
  std::array<double, 36> covariance;  ///< 6x6 row-major, order x y z rx ry rz, m and rad, in the world frame
  std::uint64_t event_count;          ///< keyframe events published up to and including this frame
  TrackingState state;
  std::uint32_t inliers;          ///< landmarks matched and kept by the pose optimisation
  std::uint32_t features_static;  ///< features offered to tracking
  std::uint32_t features_removed;
  std::uint32_t keyframes;  ///< keyframes in the map
  std::uint32_t landmarks;  ///< landmarks in the map
  std::uint32_t map_id;     ///< map that the pose is in: 0 is frame `map`; others are separate until merged
  std::uint32_t maps;       ///< maps that have not been merged
  std::array<float, kSlamStages> stage_ms;  ///< by SlamStage
};
RTD_FIELDS(rtd_msgs, TrackingResult, seq, stamp_ns, published_ns, finished_ns, T_world_camera, covariance, event_count,
           state, inliers, features_static, features_removed, keyframes, landmarks, map_id, maps, stage_ms)
constexpr const char* broken_rule(const TrackingResult& result) {
  return has_pose(result.state) && !is_rotation(result.T_world_camera.rotation_xyzw) ? "T_world_camera" : nullptr;
}

/// Whether the result is a measured pose in frame `map`.
constexpr bool is_measured_in_map(const TrackingResult& result) {
  return is_measured(result.state) && result.map_id == 0;
}
static_assert(std::is_trivially_copyable_v<KeyframeEvent> && std::is_trivially_copyable_v<TrackingResult>);

}  // namespace rtd::msg
