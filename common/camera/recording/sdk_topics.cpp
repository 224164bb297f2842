// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/sdk_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <vector>

#include "common/camera/frame_source.hpp"
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

double realsense_unit_m(const RecordedMessage& message) {
  return message.type == kText ? io::parse_number(text_of(message)).value_or(0) : number_in(message);
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

msg::CameraInfo text_camera_info(const RecordedMessage& message) {
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

constexpr std::string_view kOrbbecImages = "/cam/sensor_", kOrbbecProfiles = "/cam/streamProfileType_";
constexpr const char* kOrbbecProperties = "/cam/property";

/// Passes over a ROS 1 header.
void skip_header(ros::ByteCursor& cursor) {
  cursor.take(12);  // number and stamp
  cursor.take(cursor.read<std::uint32_t>());
}

/// Metres of a depth unit where the message is the property that has it: of Gemini 330 and its like a number of
/// millimetres, of others one of seven steps.
std::optional<double> orbbec_unit_m(const RecordedMessage& message) {
  constexpr std::uint32_t kPrecisionLevel = 75, kFlexibleUnit = 176, kBytes = 4;  // OBPropertyID
  constexpr std::array kLevels_mm = {1.0, 0.8, 0.4, 0.1, 0.2, 0.5, 0.05};
  ros::ByteCursor cursor(message.bytes);
  skip_header(cursor);
  const auto property = cursor.read<std::uint32_t>();
  if ((property != kPrecisionLevel && property != kFlexibleUnit) || cursor.read<std::uint32_t>() != kBytes) return {};
  if (property == kFlexibleUnit) return static_cast<double>(cursor.read<float>()) / 1000;
  const auto level = cursor.read<std::uint32_t>();
  return level < kLevels_mm.size() ? std::optional(kLevels_mm[level] / 1000) : std::nullopt;
}

/// The unit of depth among the properties of Orbbec's SDK; empty in recordings made before it was one of them.
std::optional<double> orbbec_unit_m(recordings::Reader& recording) {
  recording.play({kOrbbecProperties});
  while (const std::optional<RecordedMessage> message = recording.next()) {
    if (const std::optional<double> unit_m = orbbec_unit_m(*message)) return unit_m;
  }
  return std::nullopt;
}

using ProfileFields = std::map<std::string, std::vector<double>>;

/// The fields of a stream profile behind its header, which are numbers, by the definition that the recording has of
/// them, a line each: "float32[9] rotationMatrix".
ProfileFields numbers_in(const RecordedMessage& message, const std::string& definition) {
  ros::ByteCursor cursor(message.bytes);
  skip_header(cursor);
  ProfileFields numbers;
  for (const io::TextLine& line : io::split_lines(definition, " []\t\r")) {
    if (line.fields.front().starts_with('=')) break;  // other types
    if (line.fields.size() < 2 || line.fields.back() == "header") continue;
    const std::string& type = line.fields.front();
    const double count = line.fields.size() == 2 ? 1 : io::parse_number(line.fields[1]).value_or(0);
    for (int i = 0; i < count; ++i)
      numbers[line.fields.back()].push_back(type == "float32"  ? static_cast<double>(cursor.read<float>())
                                            : type == "uint16" ? cursor.read<std::uint16_t>()
                                                               : cursor.read<std::uint8_t>());
  }
  return numbers;
}

ProfileFields profile_on(recordings::Reader& recording, const std::string& topic) {
  return numbers_in(first_of(recording, topic), topic_named(recording, topic)->schema_text);
}

msg::CameraInfo orbbec_camera_info(ProfileFields profile) {
  constexpr std::array kModels = {"None",          "Modified Brown-Conrady", "Inverse Brown-Conrady",
                                  "Brown-Conrady", "Brown-Conrady",          "Kannala-Brandt"};
  const auto values = [&](const char* name, std::size_t count) {
    std::vector<double>& there = profile[name];
    there.resize(count);
    return there;
  };
  const auto k = values("cameraIntrinsic", 4);   // fx, fy, cx, cy
  const auto d = values("cameraDistortion", 8);  // k1 to k6, p1, p2
  const auto whole = [&](const char* name) {
    return static_cast<std::uint32_t>(std::max(0.0, std::min(1e5, values(name, 1)[0])));  // NaN becomes 1e5
  };
  const std::uint32_t model = whole("distortionModel");
  msg::CameraInfo info;
  info.width = whole("width");
  info.height = whole("height");
  info.k = {k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1};
  info.distortion_model = model < kModels.size() ? kModels[model] : fmt::format("{} of Orbbec", model);
  info.d = {d[0], d[1], d[6], d[7], d[2], d[3], d[4], d[5]};
  if (model == 5) info.d = {d[0], d[1], d[2], d[3]};
  return info;
}

/// Rows of a rotation and millimetres; zeros where colour was not recorded.
std::optional<Eigen::Isometry3d> orbbec_extrinsics(ProfileFields profile) {
  const auto &rotation = profile["rotationMatrix"], &translation = profile["translationMatrix"];
  if (rotation.size() != 9 || translation.size() != 3) return std::nullopt;
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3d>(rotation.data()).transpose();
  if (!(R * R.transpose()).isIdentity(0.05)) return std::nullopt;
  return Eigen::Translation3d(Eigen::Map<const Eigen::Vector3d>(translation.data()) / 1000) *
         Eigen::Quaterniond(R).normalized();
}

}  // namespace

std::string orbbec_profile_topic(const std::string& image_topic) {
  if (!image_topic.starts_with(kOrbbecImages)) return {};
  const std::size_t number = kOrbbecImages.size();
  return std::string(kOrbbecProfiles) + image_topic.substr(number, image_topic.find('/', number) - number);
}

msg::CameraInfo recorded_camera_info(recordings::Reader& recording, const std::string& topic) {
  if (topic.starts_with(kOrbbecProfiles)) return orbbec_camera_info(profile_on(recording, topic));
  const RecordedMessage message = first_of(recording, topic);
  if (message.type == kText) return text_camera_info(message);
  return ros::decode<msg::CameraInfo>(message.wire, message.bytes);
}

std::optional<double> sdk_depth_unit_m(recordings::Reader& recording, const std::string& depth_topic) {
  const bool orbbec = !orbbec_profile_topic(depth_topic).empty();
  const std::string topic = orbbec ? kOrbbecProperties : sdk_depth_unit_topic(depth_topic);
  if (topic.empty() || topic_named(recording, topic) == nullptr) return std::nullopt;
  constexpr double kMin_m = 1e-6, kMax_m = 0.1;
  const std::optional<double> unit_m = orbbec ? orbbec_unit_m(recording) : realsense_unit_m(first_of(recording, topic));
  if (!unit_m || (*unit_m >= kMin_m && *unit_m <= kMax_m)) return unit_m;  // NaN compares false
  throw SourceError(recording.name() + ", topic " + topic + ": the depth unit is " + std::to_string(*unit_m) +
                    " m, allowed is 0.000001 to 0.1; give the units of a metre with ?depth_factor=");
}

std::optional<Eigen::Isometry3d> sdk_extrinsics(recordings::Reader& recording, const std::string& color_topic,
                                                const std::string& depth_topic) {
  if (const std::string profile = orbbec_profile_topic(depth_topic); topic_named(recording, profile) != nullptr) {
    if (named_as_infrared(color_topic)) return Eigen::Isometry3d::Identity();
    return orbbec_extrinsics(profile_on(recording, profile));
  }
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
