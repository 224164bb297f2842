// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string_view>

#include "common/msg/features.hpp"

/// What a field of a message may hold, by name. The walk over the fields (common/msg/plausible.hpp) goes by this list;
/// it does not compile for a field of whole numbers that has no entry here, so that none is forgotten. Without an
/// entry:
///   floating point           finite, at most kMaxValue in size
///   int64 named *_ns         a time: at most kMaxTime_ns in size, so that differences do not overflow
///   text                     UTF-8 on one line without control characters, at most kMaxText bytes
///   sequences                at most kMaxElements, or kMaxBytes of memory for numbers
///   enumerations             up to last_value() of the type, which is next to it
namespace rtd::msg {

inline constexpr double kMaxValue = 1e15;      ///< its square is finite also as a float
inline constexpr double kMaxTime_ns = 4e18;    ///< 126 years
inline constexpr double kMaxPosition_m = 2e7;  ///< half way round the Earth; in cells of 1 cm still 32 bits
inline constexpr double kMaxPosition_px = 1e6;
inline constexpr double kMaxSequence = 1e12;  ///< of numbers that count messages: 1000 years at 30 Hz
inline constexpr std::size_t kMaxText = 1024, kMaxElements = 100'000, kMaxBytes = std::size_t{256} << 20;

enum class TextRule : std::uint8_t {
  kLine,   ///< for people: UTF-8 without control characters
  kLines,  ///< the same with line ends and tabs: whoever shows it makes it printable
  kToken,  ///< visible ASCII without spaces: names of metrics, services, frames
};

/// Bounds of one field, both included.
struct FieldRule {
  std::string_view field;  ///< "package/Type.field"; "Type*" is any type that begins so, ".*" any field
  double least = -kMaxValue, most = kMaxValue;
  std::size_t most_count = 0;  ///< elements of a sequence, bytes of a text; 0: as without an entry
  TextRule text = TextRule::kLine;
  bool free = false;  ///< any value at all
};

constexpr FieldRule free_field(std::string_view field, std::size_t most_count = 0) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  return {.field = field, .least = -kAny, .most = kAny, .most_count = most_count, .free = true};
}
constexpr FieldRule between(std::string_view field, double least, double most) {
  return {.field = field, .least = least, .most = most};
}
constexpr FieldRule within(std::string_view field, double most) {
  return between(field, -most, most);
}
constexpr FieldRule at_most(std::string_view field, std::size_t count) {
  return {.field = field, .most_count = count};
}
constexpr FieldRule text_field(std::string_view field, TextRule text, std::size_t bytes) {
  return {.field = field, .most_count = bytes, .text = text};
}

/// The first entry that fits a field counts.
inline constexpr FieldRule kFieldRules[] = {
    // ROS 2
    free_field("builtin_interfaces/Time.sec"),
    between("builtin_interfaces/Time.nanosec", 0, 999'999'999),
    free_field("builtin_interfaces/Duration.sec"),
    between("builtin_interfaces/Duration.nanosec", 0, 999'999'999),
    within("geometry_msgs/Point.*", kMaxPosition_m),
    within("geometry_msgs/Vector3.*", kMaxPosition_m),
    within("geometry_msgs/PoseWithCovariance.covariance", std::numeric_limits<double>::max()),
    within("geometry_msgs/TwistWithCovariance.covariance", std::numeric_limits<double>::max()),
    within("sensor_msgs/Imu.orientation_covariance", std::numeric_limits<double>::max()),
    within("sensor_msgs/Imu.angular_velocity_covariance", std::numeric_limits<double>::max()),
    within("sensor_msgs/Imu.linear_acceleration_covariance", std::numeric_limits<double>::max()),
    at_most("tf2_msgs/TFMessage.transforms", 10'000),
    at_most("nav_msgs/Path.poses", 1'000'000),
    between("nav_msgs/MapMetaData.resolution", 0, 1e4),
    between("nav_msgs/MapMetaData.width", 0, 65'536),
    between("nav_msgs/MapMetaData.height", 0, 65'536),
    free_field("nav_msgs/OccupancyGrid.data"),
    free_field("sensor_msgs/CompressedImage.data"),
    between("sensor_msgs/Image.height", 1, 65'536),
    between("sensor_msgs/Image.width", 1, 65'536),
    text_field("sensor_msgs/Image.encoding", TextRule::kLine, 128),
    between("sensor_msgs/Image.is_bigendian", 0, 1),
    free_field("sensor_msgs/Image.step"),  // the message's own rule
    free_field("sensor_msgs/Image.data"),
    free_field("sensor_msgs/RegionOfInterest.*"),
    between("sensor_msgs/CameraInfo.height", 0, 65'536),
    between("sensor_msgs/CameraInfo.width", 0, 65'536),
    at_most("sensor_msgs/CameraInfo.d", 64),
    free_field("sensor_msgs/CameraInfo.binning_x"),
    free_field("sensor_msgs/CameraInfo.binning_y"),
    free_field("sensor_msgs/PointField.offset"),  // the cloud's own rule, also for count
    between("sensor_msgs/PointField.datatype", 1, 8),
    free_field("sensor_msgs/PointField.count"),
    free_field("sensor_msgs/PointCloud2.height"),  // the message's own rule, also for width and steps
    free_field("sensor_msgs/PointCloud2.width"),
    at_most("sensor_msgs/PointCloud2.fields", 256),
    free_field("sensor_msgs/PointCloud2.point_step"),
    free_field("sensor_msgs/PointCloud2.row_step"),
    free_field("sensor_msgs/PointCloud2.data"),
    within("vision_msgs/Point2D.*", kMaxPosition_px),
    within("vision_msgs/BoundingBox2D.*", kMaxPosition_px),
    at_most("vision_msgs/Detection2D.results", 1000),
    at_most("vision_msgs/Detection2DArray.detections", 10'000),
    at_most("vision_msgs/Detection3D.results", 1000),
    at_most("vision_msgs/Detection3DArray.detections", 10'000),
    free_field("visualization_msgs/MeshFile.data"),
    free_field("visualization_msgs/Marker.id"),
    free_field("visualization_msgs/Marker.type"),
    free_field("visualization_msgs/Marker.action"),
    text_field("visualization_msgs/Marker.text", TextRule::kLines, 65'536),
    at_most("visualization_msgs/MarkerArray.markers", 10'000),
    between("diagnostic_msgs/DiagnosticStatus.level", 0, 3),
    text_field("diagnostic_msgs/*", TextRule::kLines, 65'536),
    free_field("std_srvs/Trigger_Request.structure_needs_at_least_one_member"),
    free_field("rcl_interfaces/*"),
    free_field("rmw_dds_common/*"),
    // ours
    text_field("rtd_msgs/WireSchema.text", TextRule::kLines, 1 << 20),
    text_field("rtd_msgs/Command_Request.argument", TextRule::kLine, 4096),
    text_field("rtd_msgs/Command_Response.message", TextRule::kLines, 65'536),
    between("rtd_msgs/RgbdFrame*.seq", 0, kMaxSequence),
    within("rtd_msgs/RgbdFrame*.distortion", 1e6),
    between("rtd_msgs/RgbdFrame*.depth_scale_m", 1e-9, 1),
    within("rtd_msgs/RgbdFrame*.readout_s", 0.1),
    within("rtd_msgs/RgbdFrame*.depth_offset_s", 0.1),
    between("rtd_msgs/RgbdFrame*.width", 1, 1920),
    between("rtd_msgs/RgbdFrame*.height", 1, 1920),
    between("rtd_msgs/RgbdFrame*.lens", 0, 1),
    free_field("rtd_msgs/RgbdFrame*.reserved"),
    free_field("rtd_msgs/RgbdFrame*.source_id"),
    free_field("rtd_msgs/RgbdFrame*.color_bgr"),
    free_field("rtd_msgs/RgbdFrame*.depth"),
    within("rtd_msgs/Feature.u_px", kMaxPosition_px),
    within("rtd_msgs/Feature.v_px", kMaxPosition_px),
    within("rtd_msgs/Feature.u_raw_px", kMaxPosition_px),
    within("rtd_msgs/Feature.v_raw_px", kMaxPosition_px),
    between("rtd_msgs/Feature.depth_m", 0, 65'536),
    within("rtd_msgs/Feature.angle_rad", 100),
    between("rtd_msgs/Feature.static_probability", 0, 1),
    between("rtd_msgs/Feature.octave", 0, 31),
    free_field("rtd_msgs/Feature.flags"),
    free_field("rtd_msgs/Feature.object_id"),
    free_field("rtd_msgs/Feature.descriptor"),
    between("rtd_msgs/FeatureFrame.seq", 0, kMaxSequence),
    within("rtd_msgs/FeatureFrame.readout_s", 0.1),
    between("rtd_msgs/FeatureFrame.width", 1, 1920),
    between("rtd_msgs/FeatureFrame.height", 1, 1920),
    between("rtd_msgs/FeatureFrame.count", 0, 4096),
    between("rtd_msgs/FeatureFrame.removed", 0, 4096),
    between("rtd_msgs/FeatureFrame.objects", 0, 1'000'000),
    between("rtd_msgs/KeyframeEvent.event_index", 0, kMaxSequence),
    between("rtd_msgs/KeyframeEvent.frame_seq", 0, kMaxSequence),
    free_field("rtd_msgs/KeyframeEvent.keyframe_id"),
    within("rtd_msgs/Transform.translation_m", kMaxPosition_m),
    between("rtd_msgs/TrackingResult.seq", 0, kMaxSequence),
    within("rtd_msgs/TrackingResult.covariance", std::numeric_limits<double>::max()),
    between("rtd_msgs/TrackingResult.event_count", 0, kMaxSequence),
    free_field("rtd_msgs/TrackingResult.inliers"),  // counts for people, never used as sizes; ids of maps
    free_field("rtd_msgs/TrackingResult.features_static"),
    free_field("rtd_msgs/TrackingResult.features_removed"),
    free_field("rtd_msgs/TrackingResult.keyframes"),
    free_field("rtd_msgs/TrackingResult.landmarks"),
    free_field("rtd_msgs/TrackingResult.map_id"),
    free_field("rtd_msgs/TrackingResult.maps"),
    text_field("rtd_msgs/ServiceStatus.service", TextRule::kToken, 64),
    between("rtd_msgs/ServiceStatus.pid", 0, 0x1p22),  // Linux has no larger one
    text_field("rtd_msgs/ServiceStatus.message", TextRule::kLine, 4096),
    at_most("rtd_msgs/ServiceStatus.metrics", 4096),
    text_field("rtd_msgs/Metric.name", TextRule::kToken, 384),
    within("rtd_msgs/Metric.value", std::numeric_limits<double>::max()),
    free_field("rtd_msgs/MapKeyframe.keyframe_id"),
    free_field("rtd_msgs/MapKeyframe.map_id"),
    between("rtd_msgs/MapKeyframe.content", 0, 7),
    within("rtd_msgs/MapKeyframe.points_m", kMaxPosition_m),
    free_field("rtd_msgs/MapKeyframe.covisible"),
    between("rtd_msgs/MapUpdate.revision", 0, kMaxSequence),
    free_field("rtd_msgs/MapUpdate.loop_edges"),
    within("rtd_msgs/KeyframeFeature.u_px", kMaxPosition_px),
    within("rtd_msgs/KeyframeFeature.v_px", kMaxPosition_px),
    between("rtd_msgs/KeyframeFeature.depth_m", 0, 65'536),
    within("rtd_msgs/KeyframeFeature.angle_rad", 100),
    free_field("rtd_msgs/KeyframeFeature.landmark_id"),
    between("rtd_msgs/KeyframeFeature.static_probability", 0, 1),
    between("rtd_msgs/KeyframeFeature.octave", 0, 31),
    free_field("rtd_msgs/KeyframeFeature.flags"),
    free_field("rtd_msgs/KeyframeFeature.descriptor"),
    between("rtd_msgs/KeyframeFeatures.width", 1, 1920),
    between("rtd_msgs/KeyframeFeatures.height", 1, 1920),
    free_field("rtd_msgs/KeyframeFeatures.keyframe_id"),
    within("rtd_msgs/KeyframeFeatures.readout_s", 0.1),
    at_most("rtd_msgs/KeyframeFeatures.features", kMaxFeatures),
    free_field("rtd_msgs/KeyframeRequest.keyframe_ids"),
    free_field("rtd_msgs/Submap.file", std::size_t{4} << 20),
    between("rtd_msgs/AtlasState.corrections", 0, kMaxSequence),
    at_most("rtd_msgs/AtlasState.robots", 256),
    text_field("rtd_msgs/AtlasRobot.name", TextRule::kToken, 32),
    within("rtd_msgs/AtlasRobot.covariance", std::numeric_limits<double>::max()),
    free_field("rtd_msgs/AtlasRobot.keyframes"),
    free_field("rtd_msgs/AtlasRobot.missing"),
    free_field("rtd_msgs/AtlasRobot.meetings"),
    between("rtd_msgs/Movers.seq", 0, kMaxSequence),
    at_most("rtd_msgs/Movers.movers", 10'000),
    free_field("rtd_msgs/Mover.id"),
    within("rtd_msgs/Mover.center_m", kMaxPosition_m),
    within("rtd_msgs/Mover.size_m", kMaxPosition_m),
    between("rtd_msgs/Mover.static_probability", 0, 1.001),  // a mean, rounded
    within("rtd_msgs/Mover.covariance", std::numeric_limits<double>::max()),
};

/// Whether an entry of the list is about this field.
constexpr bool concerns(const FieldRule& rule, std::string_view type, std::string_view field) {
  const auto fits = [](std::string_view pattern, std::string_view name) {
    return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : pattern == name;
  };
  const std::size_t point = rule.field.find('.');
  if (point == std::string_view::npos) return fits(rule.field, type);
  return fits(rule.field.substr(0, point), type) && fits(rule.field.substr(point + 1), field);
}

inline constexpr std::size_t kNoRule = std::size(kFieldRules);

/// The place of a field's entry in kFieldRules, or kNoRule.
constexpr std::size_t find_rule(std::string_view type, std::string_view field) {
  std::size_t place = 0;
  while (place < kNoRule && !concerns(kFieldRules[place], type, field)) ++place;
  return place;
}

}  // namespace rtd::msg
