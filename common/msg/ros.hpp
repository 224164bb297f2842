// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "common/msg/fields.hpp"
#include "common/msg/rotation.hpp"

/// Plain mirrors of the standard ROS 2 messages that we publish, field for field, in the order of their .msg files.
/// They carry no type of a DDS vendor.
namespace rtd::msg {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
RTD_FIELDS(builtin_interfaces, Time, sec, nanosec)
struct Header {
  Time stamp;
  std::string frame_id;
};
RTD_FIELDS(std_msgs, Header, stamp, frame_id)

struct Point {
  double x = 0, y = 0, z = 0;
};
RTD_FIELDS(geometry_msgs, Point, x, y, z)
struct Vector3 {
  double x = 0, y = 0, z = 0;
};
RTD_FIELDS(geometry_msgs, Vector3, x, y, z)
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
RTD_FIELDS(geometry_msgs, Quaternion, x, y, z, w)
constexpr const char* broken_rule(const Quaternion& q) {
  return is_rotation_or_unset({q.x, q.y, q.z, q.w}) ? nullptr : "x y z w";
}
struct Pose {
  Point position;
  Quaternion orientation;
};
RTD_FIELDS(geometry_msgs, Pose, position, orientation)
struct PoseStamped {
  Header header;
  Pose pose;
};
RTD_FIELDS(geometry_msgs, PoseStamped, header, pose)
struct PoseArray {
  Header header;
  std::vector<Pose> poses;
};
RTD_FIELDS(geometry_msgs, PoseArray, header, poses)
struct PoseWithCovariance {
  Pose pose;
  std::array<double, 36> covariance{};
};
RTD_FIELDS(geometry_msgs, PoseWithCovariance, pose, covariance)
struct Twist {
  Vector3 linear, angular;
};
RTD_FIELDS(geometry_msgs, Twist, linear, angular)
struct TwistWithCovariance {
  Twist twist;
  std::array<double, 36> covariance{};
};
RTD_FIELDS(geometry_msgs, TwistWithCovariance, twist, covariance)
struct RosTransform {
  Vector3 translation;
  Quaternion rotation;
};
RTD_FIELDS_OF(RosTransform, "geometry_msgs/Transform", translation, rotation)
struct TransformStamped {
  Header header;
  std::string child_frame_id;
  RosTransform transform;
};
RTD_FIELDS(geometry_msgs, TransformStamped, header, child_frame_id, transform)

struct TFMessage {
  std::vector<TransformStamped> transforms;
};
RTD_FIELDS(tf2_msgs, TFMessage, transforms)
struct Odometry {
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
};
RTD_FIELDS(nav_msgs, Odometry, header, child_frame_id, pose, twist)
struct Path {
  Header header;
  std::vector<PoseStamped> poses;
};
RTD_FIELDS(nav_msgs, Path, header, poses)
struct MapMetaData {
  Time map_load_time;
  float resolution = 0;  ///< m
  std::uint32_t width = 0, height = 0;
  Pose origin;  ///< of the corner of cell (0, 0)
};
RTD_FIELDS(nav_msgs, MapMetaData, map_load_time, resolution, width, height, origin)
struct OccupancyGrid {
  Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;  ///< row by row: 0 free .. 100 occupied, -1 unknown
};
RTD_FIELDS(nav_msgs, OccupancyGrid, header, info, data)
inline const char* broken_rule(const OccupancyGrid& grid) {
  return std::uint64_t{grid.info.width} * grid.info.height == grid.data.size() ? nullptr : "data";
}

struct CompressedImage {
  Header header;
  std::string format;
  std::vector<std::uint8_t> data;
};
RTD_FIELDS(sensor_msgs, CompressedImage, header, format, data)
struct Image {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;  ///< "mono8", "bgr8", ...
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  ///< bytes of a row; several drivers leave it at 0
  std::vector<std::uint8_t> data;
};
RTD_FIELDS(sensor_msgs, Image, header, height, width, encoding, is_bigendian, step, data)
/// Whole pixels without bytes between rows: then the step is not needed.
inline bool is_dense(const Image& image) {
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  return pixels > 0 && !image.data.empty() && image.data.size() % pixels == 0;
}
inline const char* broken_rule(const Image& image) {
  if (is_dense(image)) return nullptr;
  if (image.step < image.width) return "step";  // no encoding has less than a byte for a pixel
  return std::uint64_t{image.step} * image.height == image.data.size() ? nullptr : "data";
}
struct RegionOfInterest {
  std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;
  bool do_rectify = false;
};
RTD_FIELDS(sensor_msgs, RegionOfInterest, x_offset, y_offset, height, width, do_rectify)
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
RTD_FIELDS(sensor_msgs, CameraInfo, header, height, width, distortion_model, d, k, r, p, binning_x, binning_y, roi)
struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 0;
};
RTD_FIELDS(sensor_msgs, PointField, name, offset, datatype, count)
struct PointCloud2 {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = true;
};
RTD_FIELDS(sensor_msgs, PointCloud2, header, height, width, fields, is_bigendian, point_step, row_step, data, is_dense)
/// Bytes of one number of a PointField::datatype, 1 to 8.
constexpr std::uint64_t size_of(std::uint8_t datatype) {
  constexpr std::uint8_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return datatype < std::size(kSizes) ? kSizes[datatype] : 0;
}
inline const char* broken_rule(const PointCloud2& cloud) {
  for (const PointField& field : cloud.fields) {
    const std::uint64_t end = field.offset + size_of(field.datatype) * std::max(field.count, 1U);
    if (end > cloud.point_step) return "fields";
  }
  if (std::uint64_t{cloud.point_step} * cloud.width > cloud.row_step) return "row_step";
  return std::uint64_t{cloud.row_step} * cloud.height == cloud.data.size() ? nullptr : "data";
}

struct Point2D {
  double x = 0, y = 0;
};
RTD_FIELDS(vision_msgs, Point2D, x, y)
struct Pose2D {
  Point2D position;
  double theta = 0;
};
RTD_FIELDS(vision_msgs, Pose2D, position, theta)
struct BoundingBox2D {
  Pose2D center;
  double size_x = 0, size_y = 0;
};
RTD_FIELDS(vision_msgs, BoundingBox2D, center, size_x, size_y)
struct ObjectHypothesis {
  std::string class_id;
  double score = 0;
};
RTD_FIELDS(vision_msgs, ObjectHypothesis, class_id, score)
struct ObjectHypothesisWithPose {
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
};
RTD_FIELDS(vision_msgs, ObjectHypothesisWithPose, hypothesis, pose)
struct Detection2D {
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox2D bbox;
  std::string id;
};
RTD_FIELDS(vision_msgs, Detection2D, header, results, bbox, id)
struct Detection2DArray {
  Header header;
  std::vector<Detection2D> detections;
};
RTD_FIELDS(vision_msgs, Detection2DArray, header, detections)
struct BoundingBox3D {
  Pose center;
  Vector3 size;
};
RTD_FIELDS(vision_msgs, BoundingBox3D, center, size)
struct Detection3D {
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox3D bbox;
  std::string id;
};
RTD_FIELDS(vision_msgs, Detection3D, header, results, bbox, id)
struct Detection3DArray {
  Header header;
  std::vector<Detection3D> detections;
};
RTD_FIELDS(vision_msgs, Detection3DArray, header, detections)

struct Duration {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
RTD_FIELDS(builtin_interfaces, Duration, sec, nanosec)
struct ColorRGBA {
  float r = 0, g = 0, b = 0, a = 0;
};
RTD_FIELDS(std_msgs, ColorRGBA, r, g, b, a)
struct UVCoordinate {
  float u = 0, v = 0;
};
RTD_FIELDS(visualization_msgs, UVCoordinate, u, v)
struct MeshFile {
  std::string filename;
  std::vector<std::uint8_t> data;
};
RTD_FIELDS(visualization_msgs, MeshFile, filename, data)
struct Marker {
  Header header;
  std::string ns;
  std::int32_t id = 0, type = 0, action = 0;
  Pose pose;
  Vector3 scale;
  ColorRGBA color;
  Duration lifetime;
  bool frame_locked = false;
  std::vector<Point> points;
  std::vector<ColorRGBA> colors;
  std::string texture_resource;
  CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text, mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;
};
RTD_FIELDS(visualization_msgs, Marker, header, ns, id, type, action, pose, scale, color, lifetime, frame_locked, points,
           colors, texture_resource, texture, uv_coordinates, text, mesh_resource, mesh_file,
           mesh_use_embedded_materials)
struct MarkerArray {
  std::vector<Marker> markers;
};
RTD_FIELDS(visualization_msgs, MarkerArray, markers)

struct KeyValue {
  std::string key, value;
};
RTD_FIELDS(diagnostic_msgs, KeyValue, key, value)
struct DiagnosticStatus {
  std::uint8_t level = 0;  ///< 0 ok, 1 warn, 2 error, 3 stale
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};
RTD_FIELDS(diagnostic_msgs, DiagnosticStatus, level, name, message, hardware_id, values)
struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
};
RTD_FIELDS(diagnostic_msgs, DiagnosticArray, header, status)

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
