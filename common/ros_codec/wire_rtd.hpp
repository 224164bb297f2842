// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"
#include "common/ros_codec/wire.hpp"

/// The fields of our own messages (idl/rtd_msgs.idl). The plain ones also go by one memcpy: see
/// common/bus/message_types.hpp.
namespace rtd::ros {

void fields(auto& archive, Is<msg::Metric> auto& metric) {
  archive(metric.name, metric.value);
}
void fields(auto& archive, Is<msg::ServiceStatus> auto& status) {
  archive(status.service, status.pid, status.started_ns, status.stamp_ns, status.state, status.message, status.metrics);
}

template <class T>
concept IsUnaligned = Is<T, msg::Unaligned<typename T::Number>>;

template <IsUnaligned T>
void fields(auto& archive, T& value) {
  auto number = static_cast<typename T::Number>(value);
  archive(number);
  if constexpr (!std::is_const_v<T>) value = number;
}
void fields(auto& archive, Is<msg::RgbdFrame> auto& frame) {
  archive(frame.seq, frame.stamp_ns, frame.published_ns, frame.intrinsics, frame.distortion, frame.depth_scale_m,
          frame.width, frame.height, frame.source_id, frame.color_bgr, frame.depth);
}
void fields(auto& archive, Is<msg::Feature> auto& feature) {
  archive(feature.u_px, feature.v_px, feature.u_raw_px, feature.v_raw_px, feature.depth_m, feature.angle_rad,
          feature.static_probability, feature.octave, feature.flags, feature.object_id, feature.descriptor);
}
void fields(auto& archive, Is<msg::FeatureFrame> auto& frame) {
  archive(frame.seq, frame.stamp_ns, frame.published_ns, frame.intrinsics, frame.width, frame.height, frame.count,
          frame.removed, frame.objects, frame.detection_use, frame.stage_ms, frame.features);
}
void fields(auto& archive, Is<msg::Transform> auto& transform) {
  archive(transform.translation_m, transform.rotation_xyzw);
}
void fields(auto& archive, Is<msg::KeyframeEvent> auto& event) {
  archive(event.event_index, event.frame_seq, event.stamp_ns, event.T_world_camera, event.keyframe_id, event.kind);
}
void fields(auto& archive, Is<msg::TrackingResult> auto& result) {
  archive(result.seq, result.stamp_ns, result.published_ns, result.finished_ns, result.T_world_camera,
          result.covariance, result.event_count, result.state, result.inliers, result.features_static,
          result.features_removed, result.keyframes, result.landmarks, result.map_id, result.maps, result.stage_ms);
}

}  // namespace rtd::ros
