// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/recorded_extrinsics.hpp"

#include <algorithm>
#include <string>

#include "common/geometry/transform_log.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::camera {
namespace {

/// "/device_0/sensor_1/Color_0/image/data" -> "/device_0/sensor_1/Color_0/tf/"; empty for other topics.
std::string sdk_transforms(const std::string& topic) {
  constexpr const char* kData = "/image/data";
  if (!topic.starts_with("/device_") || !topic.ends_with(kData)) return {};
  return topic.substr(0, topic.rfind(kData)) + "/tf/";
}

std::optional<Eigen::Isometry3d> sdk_transform(Recording& recording, const std::string& topic) {
  const RecordedTopic* const there = topic_named(recording, topic);
  if (there == nullptr || there->type != "geometry_msgs/Transform") return std::nullopt;
  const RecordedMessage message = first_of(recording, topic);
  return geometry::to_isometry(ros::decode<msg::RosTransform>(message.wire, message.bytes));
}

/// The SDK records for each stream how points come from a reference stream (of the number at the end of the topic) into
/// it: T_stream_reference.
std::optional<Eigen::Isometry3d> sdk_extrinsics(Recording& recording, const ImageOrigin& color,
                                                const ImageOrigin& depth) {
  const std::string of_color = sdk_transforms(color.topic), of_depth = sdk_transforms(depth.topic);
  if (of_color.empty() || of_depth.empty()) return std::nullopt;
  for (const RecordedTopic& topic : recording.topics()) {
    if (!topic.name.starts_with(of_depth)) continue;
    const std::string reference = topic.name.substr(of_depth.size());
    const auto T_depth_reference = sdk_transform(recording, topic.name);
    const auto T_color_reference = sdk_transform(recording, of_color + reference);
    if (T_depth_reference && T_color_reference) return *T_color_reference * T_depth_reference->inverse();
  }
  return std::nullopt;
}

std::optional<Eigen::Isometry3d> tf_extrinsics(Recording& recording, const std::vector<std::string>& topics,
                                               const ImageOrigin& color, const ImageOrigin& depth) {
  if (topics.empty()) return std::nullopt;
  geometry::TransformLog transforms;
  recording.play(topics);
  while (const std::optional<RecordedMessage> message = recording.next()) {
    try {
      transforms.add(ros::decode<msg::TFMessage>(message->wire, message->bytes));
    } catch (const ros::WireError&) {
      continue;  // counted when it is played
    }
    if (auto T_color_depth = transforms.between(color.frame_id, depth.frame_id)) return T_color_depth;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Isometry3d> recorded_extrinsics(Recording& recording, const ImageOrigin& color,
                                                     const ImageOrigin& depth) {
  if (same_place(color, depth)) return Eigen::Isometry3d::Identity();
  if (auto T_color_depth = sdk_extrinsics(recording, color, depth)) return T_color_depth;
  if (!names_a_place(color.frame_id) || !names_a_place(depth.frame_id)) return std::nullopt;
  const std::vector<std::string> all = transform_topics(recording);
  std::vector<std::string> lasting = all;
  std::erase_if(lasting, [](const std::string& topic) { return !topic.ends_with("tf_static"); });
  if (auto T_color_depth = tf_extrinsics(recording, lasting, color, depth)) return T_color_depth;
  return tf_extrinsics(recording, all, color, depth);
}

}  // namespace rtd::camera
