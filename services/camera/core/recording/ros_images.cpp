// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/ros_images.hpp"

#include <array>
#include <map>

#include "common/ros_codec/wire_reader.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/recording/compressed_depth.hpp"

namespace rtd::camera {
namespace {

/// How the bytes of an encoding lie.
struct PixelLayout {
  int type;                        ///< OpenCV's
  std::array<int, 3> bgr_channel;  ///< where blue, green and red stand
};
const std::map<std::string, PixelLayout> kColorLayouts = {
    {"bgr8", {CV_8UC3, {0, 1, 2}}},  {"8UC3", {CV_8UC3, {0, 1, 2}}},  {"rgb8", {CV_8UC3, {2, 1, 0}}},
    {"bgra8", {CV_8UC4, {0, 1, 2}}}, {"rgba8", {CV_8UC4, {2, 1, 0}}}, {"mono8", {CV_8UC1, {0, 0, 0}}},
    {"8UC1", {CV_8UC1, {0, 0, 0}}}};
const std::map<std::string, int> kDepthTypes = {{"16UC1", CV_16UC1}, {"mono16", CV_16UC1}, {"32FC1", CV_32FC1}};

constexpr const char* kCompressed = "sensor_msgs/CompressedImage";

SourceError unsupported(const RecordedMessage& message, const std::string& encoding, const std::string& known) {
  return SourceError(message.topic + " is encoded as '" + encoding + "', which cannot be read; readable: " + known);
}

ImageRead refuse(SkipReason reason, const RecordedMessage& message, const std::string& cause) {
  return {{}, SkippedInput{reason, name_of(message) + ": " + cause}};
}

/// The pixels where they lie in the message. Throws ros::WireError when the message holds fewer than it claims.
cv::Mat view_of(msg::Image& image, int type) {
  const std::size_t row_bytes = std::size_t{image.width} * static_cast<std::size_t>(CV_ELEM_SIZE(type));
  if (image.width == 0 || image.height == 0 || image.step < row_bytes ||
      image.data.size() / image.step < image.height) {
    throw ros::WireError(std::to_string(image.width) + " x " + std::to_string(image.height) + " px of " +
                         image.encoding + " in rows of " + std::to_string(image.step) + " bytes do not fit into " +
                         std::to_string(image.data.size()) + " bytes");
  }
  return {static_cast<int>(image.height), static_cast<int>(image.width), type, image.data.data(), image.step};
}

ImageRead raw_color(const RecordedMessage& message) {
  auto image = ros::decode<msg::Image>(message.wire, message.bytes);
  const auto layout = kColorLayouts.find(image.encoding);
  if (layout == kColorLayouts.end()) {
    throw unsupported(message, image.encoding, "rgb8, bgr8, rgba8, bgra8, mono8, JPEG, PNG");
  }
  const cv::Mat pixels = view_of(image, layout->second.type);
  ImageRead result{cv::Mat(pixels.size(), CV_8UC3), {}};
  const auto& channel = layout->second.bgr_channel;
  const std::array<int, 6> from_to = {channel[0], 0, channel[1], 1, channel[2], 2};
  cv::mixChannels(&pixels, 1, &result.image, 1, from_to.data(), 3);
  return result;
}

int depth_type(const RecordedMessage& message, const msg::Image& image) {
  const auto type = kDepthTypes.find(image.encoding);
  if (type == kDepthTypes.end()) {
    throw unsupported(message, image.encoding, "16UC1 (mm), mono16, 32FC1 (m), 16-bit PNG, compressedDepth (PNG)");
  }
  if (image.is_bigendian != 0) throw unsupported(message, image.encoding + ", big endian", "little endian");
  return type->second;
}

ImageRead raw_depth(const RecordedMessage& message, double float_unit_m) {
  auto image = ros::decode<msg::Image>(message.wire, message.bytes);
  const int type = depth_type(message, image);
  const cv::Mat pixels = view_of(image, type);
  ImageRead result{type == CV_32FC1 ? quantize_depth(pixels, float_unit_m) : pixels.clone(), {}};
  drop_saturated(result.image);
  return result;
}

ImageRead compressed_depth(const RecordedMessage& message, double float_unit_m) {
  const auto image = ros::decode<msg::CompressedImage>(message.wire, message.bytes);
  if (!is_compressed_depth(image)) return decode_depth(image.data, name_of(message));
  return decode_compressed_depth(image, name_of(message), float_unit_m);
}

}  // namespace

std::string name_of(const RecordedMessage& message) {
  return message.topic + " recorded at " + std::to_string(message.recorded_ns) + " ns";
}

ImageRead decode_color(const RecordedMessage& message, const std::string& type) try {
  if (type != kCompressed) return raw_color(message);
  const auto image = ros::decode<msg::CompressedImage>(message.wire, message.bytes);
  return decode_color(image.data, name_of(message));
} catch (const ros::WireError& error) {
  return refuse(SkipReason::kColorUnreadable, message, error.what());
}

ImageRead decode_depth(const RecordedMessage& message, const std::string& type, double float_unit_m) try {
  return type == kCompressed ? compressed_depth(message, float_unit_m) : raw_depth(message, float_unit_m);
} catch (const ros::WireError& error) {
  return refuse(SkipReason::kDepthUnreadable, message, error.what());
}

double depth_unit_m(const RecordedMessage& message, const std::string& type, double float_unit_m) {
  bool floats = false;
  if (type == kCompressed) {
    floats = ros::decode<msg::CompressedImage>(message.wire, message.bytes).format.starts_with("32FC1");
  } else {
    floats = depth_type(message, ros::decode<msg::Image>(message.wire, message.bytes)) == CV_32FC1;
  }
  return floats ? float_unit_m : kMillimetre;
}

}  // namespace rtd::camera
