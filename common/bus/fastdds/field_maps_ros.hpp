// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <diagnostic_msgsPubSubTypes.h>
#include <nav_msgsPubSubTypes.h>
#include <sensor_msgsPubSubTypes.h>
#include <tf2_msgsPubSubTypes.h>
#include <vision_msgsPubSubTypes.h>

#include "common/bus/fastdds/field_map.hpp"
#include "common/bus/fastdds/field_maps_geometry.hpp"

/// nav_msgs, tf2_msgs, sensor_msgs, vision_msgs and diagnostic_msgs.
namespace rtd::bus::fastdds {

// clang-format off
template <> struct FieldMap<msg::Odometry> {
  using Vendor = nav_msgs::msg::dds_::Odometry_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.child_frame_id, vendor.child_frame_id());
    copy(plain.pose, vendor.pose());
    copy(plain.twist, vendor.twist());
  }
};
template <> struct FieldMap<msg::Path> {
  using Vendor = nav_msgs::msg::dds_::Path_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.poses, vendor.poses());
  }
};
template <> struct FieldMap<msg::TFMessage> {
  using Vendor = tf2_msgs::msg::dds_::TFMessage_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.transforms, vendor.transforms());
  }
};
template <> struct FieldMap<msg::CompressedImage> {
  using Vendor = sensor_msgs::msg::dds_::CompressedImage_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.format, vendor.format());
    copy(plain.data, vendor.data());
  }
};
template <> struct FieldMap<msg::Image> {
  using Vendor = sensor_msgs::msg::dds_::Image_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.height, vendor.height());
    copy(plain.width, vendor.width());
    copy(plain.encoding, vendor.encoding());
    copy(plain.is_bigendian, vendor.is_bigendian());
    copy(plain.step, vendor.step());
    copy(plain.data, vendor.data());
  }
};
template <> struct FieldMap<msg::RegionOfInterest> {
  using Vendor = sensor_msgs::msg::dds_::RegionOfInterest_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.x_offset, vendor.x_offset());
    copy(plain.y_offset, vendor.y_offset());
    copy(plain.height, vendor.height());
    copy(plain.width, vendor.width());
    copy(plain.do_rectify, vendor.do_rectify());
  }
};
template <> struct FieldMap<msg::CameraInfo> {
  using Vendor = sensor_msgs::msg::dds_::CameraInfo_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.height, vendor.height());
    copy(plain.width, vendor.width());
    copy(plain.distortion_model, vendor.distortion_model());
    copy(plain.d, vendor.d());
    copy(plain.k, vendor.k());
    copy(plain.r, vendor.r());
    copy(plain.p, vendor.p());
    copy(plain.binning_x, vendor.binning_x());
    copy(plain.binning_y, vendor.binning_y());
    copy(plain.roi, vendor.roi());
  }
};
template <> struct FieldMap<msg::PointField> {
  using Vendor = sensor_msgs::msg::dds_::PointField_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.name, vendor.name());
    copy(plain.offset, vendor.offset());
    copy(plain.datatype, vendor.datatype());
    copy(plain.count, vendor.count());
  }
};
template <> struct FieldMap<msg::PointCloud2> {
  using Vendor = sensor_msgs::msg::dds_::PointCloud2_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.height, vendor.height());
    copy(plain.width, vendor.width());
    copy(plain.fields, vendor.fields());
    copy(plain.is_bigendian, vendor.is_bigendian());
    copy(plain.point_step, vendor.point_step());
    copy(plain.row_step, vendor.row_step());
    copy(plain.data, vendor.data());
    copy(plain.is_dense, vendor.is_dense());
  }
};
template <> struct FieldMap<msg::Point2D> {
  using Vendor = vision_msgs::msg::dds_::Point2D_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.x, vendor.x());
    copy(plain.y, vendor.y());
  }
};
template <> struct FieldMap<msg::Pose2D> {
  using Vendor = vision_msgs::msg::dds_::Pose2D_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.position, vendor.position());
    copy(plain.theta, vendor.theta());
  }
};
template <> struct FieldMap<msg::BoundingBox2D> {
  using Vendor = vision_msgs::msg::dds_::BoundingBox2D_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.center, vendor.center());
    copy(plain.size_x, vendor.size_x());
    copy(plain.size_y, vendor.size_y());
  }
};
template <> struct FieldMap<msg::ObjectHypothesis> {
  using Vendor = vision_msgs::msg::dds_::ObjectHypothesis_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.class_id, vendor.class_id());
    copy(plain.score, vendor.score());
  }
};
template <> struct FieldMap<msg::ObjectHypothesisWithPose> {
  using Vendor = vision_msgs::msg::dds_::ObjectHypothesisWithPose_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.hypothesis, vendor.hypothesis());
    copy(plain.pose, vendor.pose());
  }
};
template <> struct FieldMap<msg::Detection2D> {
  using Vendor = vision_msgs::msg::dds_::Detection2D_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.results, vendor.results());
    copy(plain.bbox, vendor.bbox());
    copy(plain.id, vendor.id());
  }
};
template <> struct FieldMap<msg::Detection2DArray> {
  using Vendor = vision_msgs::msg::dds_::Detection2DArray_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.detections, vendor.detections());
  }
};
template <> struct FieldMap<msg::KeyValue> {
  using Vendor = diagnostic_msgs::msg::dds_::KeyValue_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.key, vendor.key());
    copy(plain.value, vendor.value());
  }
};
template <> struct FieldMap<msg::DiagnosticStatus> {
  using Vendor = diagnostic_msgs::msg::dds_::DiagnosticStatus_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.level, vendor.level());
    copy(plain.name, vendor.name());
    copy(plain.message, vendor.message());
    copy(plain.hardware_id, vendor.hardware_id());
    copy(plain.values, vendor.values());
  }
};
template <> struct FieldMap<msg::DiagnosticArray> {
  using Vendor = diagnostic_msgs::msg::dds_::DiagnosticArray_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.status, vendor.status());
  }
};
// clang-format on

}  // namespace rtd::bus::fastdds
