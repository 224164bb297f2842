// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "common/msg/ros.hpp"

/// The fields of the standard messages that recordings hold, each listed once for every wire format and both
/// directions.
namespace rtd::ros {

/// How a message is written down.
enum class Wire {
  kRos1,  ///< ROS 1: packed, a header begins with a counter, strings without end mark
  kCdr    ///< ROS 2: XCDR1 little endian behind a 4-byte header; numbers aligned, strings end with NUL
};

template <class T, class Plain>
concept Is = std::same_as<std::remove_const_t<T>, Plain>;

void fields(auto& archive, Is<msg::Time> auto& time) {
  archive(time.sec, time.nanosec);
}
template <class Archive>
void fields(Archive& archive, Is<msg::Header> auto& header) {
  if constexpr (Archive::kWire == Wire::kRos1) {
    std::uint32_t seq = 0;  // of the publisher; nobody here needs it
    archive(seq);
  }
  archive(header.stamp, header.frame_id);
}
void fields(auto& archive, Is<msg::Vector3> auto& vector) {
  archive(vector.x, vector.y, vector.z);
}
void fields(auto& archive, Is<msg::Quaternion> auto& rotation) {
  archive(rotation.x, rotation.y, rotation.z, rotation.w);
}
void fields(auto& archive, Is<msg::RosTransform> auto& transform) {
  archive(transform.translation, transform.rotation);
}
void fields(auto& archive, Is<msg::TransformStamped> auto& message) {
  archive(message.header, message.child_frame_id, message.transform);
}
void fields(auto& archive, Is<msg::TFMessage> auto& message) {
  archive(message.transforms);
}
void fields(auto& archive, Is<msg::CompressedImage> auto& message) {
  archive(message.header, message.format, message.data);
}
void fields(auto& archive, Is<msg::Image> auto& message) {
  archive(message.header, message.height, message.width, message.encoding, message.is_bigendian, message.step,
          message.data);
}
void fields(auto& archive, Is<msg::RegionOfInterest> auto& roi) {
  archive(roi.x_offset, roi.y_offset, roi.height, roi.width, roi.do_rectify);
}
void fields(auto& archive, Is<msg::CameraInfo> auto& message) {
  archive(message.header, message.height, message.width, message.distortion_model, message.d, message.k, message.r,
          message.p, message.binning_x, message.binning_y, message.roi);
}

}  // namespace rtd::ros
