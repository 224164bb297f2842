// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// Plain mirrors of the standard ROS 2 messages that we publish, field for field, in the order of their .msg files.
/// They carry no vendor type; common/bus converts them to the generated types of each DDS vendor.
namespace rtd::msg {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
struct Header {
  Time stamp;
  std::string frame_id;
};

struct Point {
  double x = 0, y = 0, z = 0;
};
struct Vector3 {
  double x = 0, y = 0, z = 0;
};
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
struct Pose {
  Point position;
  Quaternion orientation;
};
struct PoseStamped {
  Header header;
  Pose pose;
};
struct PoseWithCovariance {
  Pose pose;
  std::array<double, 36> covariance{};
};
struct Twist {
  Vector3 linear, angular;
};
struct TwistWithCovariance {
  Twist twist;
  std::array<double, 36> covariance{};
};
struct RosTransform {
  Vector3 translation;
  Quaternion rotation;
};
struct TransformStamped {
  Header header;
  std::string child_frame_id;
  RosTransform transform;
};

struct TFMessage {
  std::vector<TransformStamped> transforms;
};
struct Odometry {
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
};
struct Path {
  Header header;
  std::vector<PoseStamped> poses;
};

struct CompressedImage {
  Header header;
  std::string format;
  std::vector<std::uint8_t> data;
};
struct Image {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;  ///< "mono8", "bgr8", ...
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  ///< bytes of a row
  std::vector<std::uint8_t> data;
};
struct RegionOfInterest {
  std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;
  bool do_rectify = false;
};
struct CameraInfo {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  RegionOfInterest roi;
};
struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 0;
};
struct PointCloud2 {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = true;
};

struct Point2D {
  double x = 0, y = 0;
};
struct Pose2D {
  Point2D position;
  double theta = 0;
};
struct BoundingBox2D {
  Pose2D center;
  double size_x = 0, size_y = 0;
};
struct ObjectHypothesis {
  std::string class_id;
  double score = 0;
};
struct ObjectHypothesisWithPose {
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
};
struct Detection2D {
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox2D bbox;
  std::string id;
};
struct Detection2DArray {
  Header header;
  std::vector<Detection2D> detections;
};

struct KeyValue {
  std::string key, value;
};
struct DiagnosticStatus {
  std::uint8_t level = 0;  ///< 0 ok, 1 warn, 2 error, 3 stale
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};
struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
};

/// Nanoseconds <-> ROS time. Negative stamps floor towards minus infinity, nanosec stays in [0, 1e9).
constexpr Time to_time(std::int64_t stamp_ns) {
  std::int64_t sec = stamp_ns / 1'000'000'000, nanosec = stamp_ns % 1'000'000'000;
  if (nanosec < 0) {
    nanosec += 1'000'000'000;
    --sec;
  }
  return {static_cast<std::int32_t>(sec), static_cast<std::uint32_t>(nanosec)};
}
constexpr std::int64_t to_ns(const Time& time) {
  return std::int64_t{time.sec} * 1'000'000'000 + time.nanosec;
}

}  // namespace rtd::msg
