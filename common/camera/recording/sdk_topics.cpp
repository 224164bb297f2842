// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/sdk_topics.hpp"

#include <algorithm>

#include "common/camera/frame_source.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/camera/settings_text.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/io/text.hpp"
#include "common/ros_codec/byte_cursor.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::camera {
namespace {

constexpr const char* kText = "std_msgs/String";

/// Without the zero at its end.
std::string text_of(const RecordedMessage& message) {
  ros::ByteCursor cursor(message.bytes);
  if (message.wire == ros::Wire::kCdr) cursor.take(4);  // header
  const auto length = cursor.read<std::uint32_t>();
  std::string text = ros::to_text(cursor.take(length));
  if (text.ends_with('\0')) text.pop_back();
  return text;
}

/// std_msgs/Float32.
double number_in(const RecordedMessage& message) {
  ros::ByteCursor cursor(message.bytes);
  if (message.wire == ros::Wire::kCdr) cursor.take(4);  // header
  return static_cast<double>(cursor.read<float>());
}

SettingsText settings_of(const RecordedMessage& message) {
  std::string text = text_of(message);
  std::ranges::replace(text, ';', '\n');
  return SettingsText(text);
}

/// "/device_0/sensor_1/Color_0/image/data" -> "/device_0/sensor_1/Color_0/tf/"; empty for other topics.
std::string transforms_of(const std::string& topic) {
  const std::size_t data = topic.rfind("/image/data");
  return topic.starts_with("/device_") && data != std::string::npos ? topic.substr(0, data) + "/tf/" : std::string();
}

std::optional<Eigen::Isometry3d> transform_at(recordings::Reader& recording, const std::string& topic) {
  const RecordedTopic* const there = topic_named(recording, topic);
  if (there == nullptr) return std::nullopt;
  const RecordedMessage message = first_of(recording, topic);
  if (there->type == "geometry_msgs/Transform")
    return geometry::to_isometry(ros::decode<msg::RosTransform>(message.wire, message.bytes));
  if (there->type != kText) return std::nullopt;
  const SettingsText text = settings_of(message);
  const std::vector<double> rotation = text.numbers("rotation"), translation = text.numbers("translation");
  if (rotation.size() != 9 || translation.size() != 3) return std::nullopt;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Map<const Eigen::Matrix3d>(rotation.data());  // by columns
  T.translation() = Eigen::Map<const Eigen::Vector3d>(translation.data());
  return T;
}

}  // namespace

bool is_sdk_text(const RecordedMessage& message) {
  return message.type == kText;
}

msg::CameraInfo sdk_camera_info(const RecordedMessage& message) {
  const SettingsText text = settings_of(message);
  const auto number = [&](const char* key) {
    const std::optional<double> value = text.number(key);
    if (!value) throw ros::WireError("the text on " + message.topic + " has no number '" + key + "'");
    return *value;
  };
  const auto side = [&](const char* key) { return static_cast<std::uint32_t>(std::clamp(number(key), 0.0, 1e5)); };
  msg::CameraInfo info;
  info.width = side("width");
  info.height = side("height");
  info.k = {number("fx"), 0, number("ppx"), 0, number("fy"), number("ppy"), 0, 0, 1};
  info.distortion_model = text.text("model");
  info.d = text.numbers("coeffs");
  return info;
}

std::optional<double> sdk_depth_unit_m(recordings::Reader& recording, const std::string& depth_topic) {
  const std::string topic = sdk_depth_unit_topic(depth_topic);
  if (topic.empty() || topic_named(recording, topic) == nullptr) return std::nullopt;
  constexpr double kMin_m = 1e-6, kMax_m = 0.1;
  const RecordedMessage message = first_of(recording, topic);
  const double unit_m = is_sdk_text(message) ? io::parse_number(text_of(message)).value_or(0) : number_in(message);
  if (unit_m >= kMin_m && unit_m <= kMax_m) return unit_m;  // NaN compares false
  throw SourceError(recording.name() + ", topic " + topic + ": the depth unit is " + std::to_string(unit_m) +
                    " m, allowed is 0.000001 to 0.1; give the units of a metre with ?depth_factor=");
}

std::optional<Eigen::Isometry3d> sdk_extrinsics(recordings::Reader& recording, const std::string& color_topic,
                                                const std::string& depth_topic) {
  const std::string of_color = transforms_of(color_topic), of_depth = transforms_of(depth_topic);
  if (of_color.empty() || of_depth.empty()) return std::nullopt;
  for (const RecordedTopic& topic : recording.topics()) {
    if (!topic.name.starts_with(of_depth)) continue;
    const std::string reference = topic.name.substr(of_depth.size());
    const auto T_depth_reference = transform_at(recording, topic.name);
    const auto T_color_reference = transform_at(recording, of_color + reference);
    if (T_depth_reference && T_color_reference) return *T_color_reference * T_depth_reference->inverse();
  }
  return std::nullopt;
}

}  // namespace rtd::camera
