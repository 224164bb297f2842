// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "common/msg/fields.hpp"
#include "common/msg/frame_size.hpp"

namespace rtd::msg {

inline constexpr std::uint32_t kMaxFeatures = 4096;
/// How many times an image of this size is enlarged before features are looked for: small ones are doubled
/// (docs/theory/orb.md). The positions of features are given in pixels of the image as it came.
constexpr int feature_scale(std::uint32_t width_px, std::uint32_t height_px) {
  return width_px < 400 && height_px < 400 ? 2 : 1;
}

using Descriptor = std::array<std::uint8_t, 32>;  ///< rotated BRIEF, 256 bits

/// Bits of Feature::flags.
enum FeatureFlag : std::uint8_t {
  kFeatureRemoved = 1U << 0,         ///< judged dynamic: SLAM must not use it; sent so that viewers can draw it
  kFeatureInHighMask = 1U << 1,      ///< inside the mask of a high-motion object (person, animal)
  kFeatureInMediumMask = 1U << 2,    ///< inside the mask of a medium-motion object (chair, book)
  kFeatureInLowMask = 1U << 3,       ///< inside the mask of a low-motion object (tv, refrigerator)
  kFeatureGeometryMoving = 1U << 4,  ///< the multi-view depth check found motion here
  kFeatureGeometryStatic = 1U << 5,  ///< the multi-view depth check found this point where it expected it
  kFeatureInQuestion = 1U << 6,      ///< it is too early to say whether its surface moves: SLAM may map it, no more
};

/// One ORB feature with what is known about its motion.
struct Feature {
  float u_px, v_px;          ///< undistorted pixel position: project with fx fy cx cy only
  float u_raw_px, v_raw_px;  ///< pixel position in the camera's own image (for drawing)
  float depth_m;             ///< metres along z, 0 = not measured
  float angle_rad;           ///< orientation of the patch
  float static_probability;  ///< [0, 1]; 1 = certainly part of the static world
  std::uint8_t octave;       ///< pyramid level, scale 1.2^octave
  std::uint8_t flags;        ///< FeatureFlag bits
  std::int16_t object_id;    ///< index of the object of this frame that the feature lies on, -1 = background
  Descriptor descriptor;
};
static_assert(sizeof(Feature) == 64 && std::is_trivially_copyable_v<Feature>);
RTD_FIELDS(rtd_msgs, Feature, u_px, v_px, u_raw_px, v_raw_px, depth_m, angle_rad, static_probability, octave, flags,
           object_id, descriptor)

/// Stages of the filter whose time travels in FeatureFrame::stage_ms.
enum FilterStage : std::uint32_t {
  kStageWaitDetections,
  kStageExtract,
  kStageMasks,
  kStageEgoMotion,
  kStageDepthCheck,
  kStageFuse,
  kStageFilterTotal,
  kFilterStages = 8
};

/// How the filter used the detector for this frame.
enum class DetectionUse : std::uint32_t { kNone = 0, kExact = 1, kCarried = 2, kDetectorGone = 3 };
constexpr DetectionUse last_value(TypeOf<DetectionUse>) {
  return DetectionUse::kDetectorGone;
}

/// The features of one frame: topic `rtd/features`. Plain and of fixed size; entries after `count` are zero.
struct FeatureFrame {
  std::uint64_t seq;                 ///< seq of the RgbdFrame
  std::int64_t stamp_ns;             ///< stamp of the RgbdFrame
  std::int64_t published_ns;         ///< copied from the RgbdFrame: the start of the camera -> pose latency
  std::array<double, 4> intrinsics;  ///< fx fy cx cy of the undistorted image
  double readout_s;                  ///< copied from the RgbdFrame, s: the features are where their rows saw them
  std::uint32_t width, height;       ///< px
  std::uint32_t count;               ///< used entries of `features`
  std::uint32_t removed;             ///< how many of them carry kFeatureRemoved
  std::uint32_t objects;             ///< objects seen in this frame
  DetectionUse detection_use;
  std::array<float, kFilterStages> stage_ms;  ///< by FilterStage
  std::array<Feature, kMaxFeatures> features;
};
static_assert(std::is_trivially_copyable_v<FeatureFrame> && std::is_standard_layout_v<FeatureFrame>);
RTD_FIELDS(rtd_msgs, FeatureFrame, seq, stamp_ns, published_ns, intrinsics, readout_s, width, height, count, removed,
           objects, detection_use, stage_ms, features)
inline std::span<const Feature> used_part(const FeatureFrame& frame, const std::array<Feature, kMaxFeatures>& all) {
  return std::span(all).first(std::min(frame.count, kMaxFeatures));
}
inline const char* broken_rule(const FeatureFrame& frame) {
  if (!is_frame_size(frame.width, frame.height)) return "width and height";
  if (!is_camera(frame.intrinsics, frame.width, frame.height)) return "intrinsics";
  return frame.removed <= frame.count ? nullptr : "removed";
}

}  // namespace rtd::msg
