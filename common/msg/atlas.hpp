// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/fields.hpp"
#include "common/msg/frame_size.hpp"
#include "common/msg/tracking.hpp"

/// What robots and the atlas send each other (docs/atlas.md). The atlas follows `rtd/map` of each robot, which says
/// which keyframes there are and where; it asks for the features of those that it does not have.
namespace rtd::msg {

inline constexpr std::uint32_t kNoId = 0xFFFFFFFF;

/// One ORB feature of a keyframe.
struct KeyframeFeature {
  float u_px = 0, v_px = 0;  ///< undistorted pixel position, in the raster of the keyframe
  float depth_m = 0;         ///< along z: of its landmark where it has one, else as measured; 0 = not known
  float angle_rad = 0;
  std::uint32_t landmark_id = kNoId;  ///< of the robot: a landmark that was seen to rest; kNoId = none
  float static_probability = 0;
  std::uint8_t octave = 0;
  std::uint8_t flags = 0;  ///< FeatureFlag bits
  Descriptor descriptor{};
};
RTD_FIELDS(rtd_msgs, KeyframeFeature, u_px, v_px, depth_m, angle_rad, landmark_id, static_probability, octave, flags,
           descriptor)

/// The features of a keyframe that was asked for, or of a frame whose place is asked for: topic
/// `rtd/keyframe_features`.
struct KeyframeFeatures {
  std::int64_t session_ns = 0;        ///< MapUpdate::session_ns
  std::uint32_t keyframe_id = kNoId;  ///< kNoId: where is this? The answer is a Submap
  std::int64_t stamp_ns = 0;
  std::array<double, 4> intrinsics{};     ///< fx fy cx cy, px of the raster
  double disparity_px_m = 0;              ///< weight of depth, docs/theory/camera.md (5)
  double readout_s = 0;                   ///< of a rolling shutter, undone in the features
  std::uint32_t width = 0, height = 0;    ///< px of the raster
  std::vector<KeyframeFeature> features;  ///< at most kMaxFeatures
};
RTD_FIELDS(rtd_msgs, KeyframeFeatures, session_ns, keyframe_id, stamp_ns, intrinsics, disparity_px_m, readout_s, width,
           height, features)
inline const char* broken_rule(const KeyframeFeatures& keyframe) {
  if (!is_camera(keyframe.intrinsics, keyframe.width, keyframe.height)) return "intrinsics";
  return keyframe.disparity_px_m > 0 ? nullptr : "disparity_px_m";
}

/// Keyframes of a robot whose features the atlas asks for, most wanted first: topic `rtd/keyframe_request`.
struct KeyframeRequest {
  std::int64_t session_ns = 0;  ///< MapUpdate::session_ns: of another session, they are not sent
  std::vector<std::uint32_t> keyframe_ids;
};
RTD_FIELDS(rtd_msgs, KeyframeRequest, session_ns, keyframe_ids)

/// The part of the joint map around the place where a robot is: topic `rtd/submap`.
struct Submap {
  std::int64_t stamp_ns = 0;       ///< of the frame that was asked about
  Transform T_map_camera{};        ///< pose of that frame in the joint map
  std::vector<std::uint8_t> file;  ///< a map file (docs/map_file.md), its ids are those of the atlas
};
RTD_FIELDS(rtd_msgs, Submap, stamp_ns, T_map_camera, file)
inline const char* broken_rule(const Submap& submap) {
  return is_rotation(submap.T_map_camera.rotation_xyzw) ? nullptr : "T_map_camera";
}

/// One robot in the joint map.
struct AtlasRobot {
  std::string name;
  bool met = false;                     ///< false: its map has not met the joint map; what follows is void
  Transform T_map_robot;                ///< frame `NAME/map` in frame `map`
  std::array<double, 36> covariance{};  ///< of T_map_robot, (x y z rx ry rz) in frame `map`, m and rad
  Transform T_map_camera;               ///< its newest keyframe in frame `map`
  std::int64_t stamp_ns = 0;            ///< of that keyframe
  std::uint32_t keyframes = 0;          ///< that the atlas keeps of it
  std::uint32_t missing = 0;            ///< that it still has to send
  std::uint32_t meetings = 0;           ///< places where it met what others, or itself on an earlier visit, had mapped
};
RTD_FIELDS(rtd_msgs, AtlasRobot, name, met, T_map_robot, covariance, T_map_camera, stamp_ns, keyframes, missing,
           meetings)
inline const char* broken_rule(const AtlasRobot& robot) {
  if (!is_rotation(robot.T_map_robot.rotation_xyzw)) return "T_map_robot";
  return is_rotation(robot.T_map_camera.rotation_xyzw) ? nullptr : "T_map_camera";
}

/// Where the robots are: topic `rtd/atlas`.
struct AtlasState {
  std::int64_t stamp_ns = 0;
  std::uint64_t corrections = 0;  ///< how often the joint map has been straightened
  std::vector<AtlasRobot> robots;
};
RTD_FIELDS(rtd_msgs, AtlasState, stamp_ns, corrections, robots)

}  // namespace rtd::msg
