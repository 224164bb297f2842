// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "common/msg/ros.hpp"

/// The fields of the standard messages, each listed once for every wire format and both directions. Those of our own
/// messages: wire_rtd.hpp.
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
void fields(auto& archive, Is<msg::Point> auto& point) {
  archive(point.x, point.y, point.z);
}
void fields(auto& archive, Is<msg::Vector3> auto& vector) {
  archive(vector.x, vector.y, vector.z);
}
void fields(auto& archive, Is<msg::Quaternion> auto& rotation) {
  archive(rotation.x, rotation.y, rotation.z, rotation.w);
}
void fields(auto& archive, Is<msg::Pose> auto& pose) {
  archive(pose.position, pose.orientation);
}
void fields(auto& archive, Is<msg::PoseStamped> auto& message) {
  archive(message.header, message.pose);
}
void fields(auto& archive, Is<msg::PoseWithCovariance> auto& message) {
  archive(message.pose, message.covariance);
}
void fields(auto& archive, Is<msg::Twist> auto& twist) {
  archive(twist.linear, twist.angular);
}
void fields(auto& archive, Is<msg::TwistWithCovariance> auto& message) {
  archive(message.twist, message.covariance);
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

void fields(auto& archive, Is<msg::Odometry> auto& message) {
  archive(message.header, message.child_frame_id, message.pose, message.twist);
}
void fields(auto& archive, Is<msg::Path> auto& message) {
  archive(message.header, message.poses);
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
void fields(auto& archive, Is<msg::PointField> auto& field) {
  archive(field.name, field.offset, field.datatype, field.count);
}
void fields(auto& archive, Is<msg::PointCloud2> auto& message) {
  archive(message.header, message.height, message.width, message.fields, message.is_bigendian, message.point_step,
          message.row_step, message.data, message.is_dense);
}

void fields(auto& archive, Is<msg::Point2D> auto& point) {
  archive(point.x, point.y);
}
void fields(auto& archive, Is<msg::Pose2D> auto& pose) {
  archive(pose.position, pose.theta);
}
void fields(auto& archive, Is<msg::BoundingBox2D> auto& box) {
  archive(box.center, box.size_x, box.size_y);
}
void fields(auto& archive, Is<msg::ObjectHypothesis> auto& hypothesis) {
  archive(hypothesis.class_id, hypothesis.score);
}
void fields(auto& archive, Is<msg::ObjectHypothesisWithPose> auto& message) {
  archive(message.hypothesis, message.pose);
}
void fields(auto& archive, Is<msg::Detection2D> auto& message) {
  archive(message.header, message.results, message.bbox, message.id);
}
void fields(auto& archive, Is<msg::Detection2DArray> auto& message) {
  archive(message.header, message.detections);
}

void fields(auto& archive, Is<msg::KeyValue> auto& pair) {
  archive(pair.key, pair.value);
}
void fields(auto& archive, Is<msg::DiagnosticStatus> auto& message) {
  archive(message.level, message.name, message.message, message.hardware_id, message.values);
}
void fields(auto& archive, Is<msg::DiagnosticArray> auto& message) {
  archive(message.header, message.status);
}

}  // namespace rtd::ros
