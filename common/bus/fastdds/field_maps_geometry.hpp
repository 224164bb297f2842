// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <builtin_interfacesPubSubTypes.h>
#include <geometry_msgsPubSubTypes.h>
#include <std_msgsPubSubTypes.h>

#include "common/bus/fastdds/field_map.hpp"
#include "common/msg/ros.hpp"

/// builtin_interfaces, std_msgs and geometry_msgs.
namespace rtd::bus::fastdds {

// clang-format off
template <> struct FieldMap<msg::Time> {
  using Vendor = builtin_interfaces::msg::dds_::Time_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.sec, vendor.sec());
    copy(plain.nanosec, vendor.nanosec());
  }
};
template <> struct FieldMap<msg::Header> {
  using Vendor = std_msgs::msg::dds_::Header_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.stamp, vendor.stamp());
    copy(plain.frame_id, vendor.frame_id());
  }
};
template <> struct FieldMap<msg::Point> {
  using Vendor = geometry_msgs::msg::dds_::Point_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.x, vendor.x());
    copy(plain.y, vendor.y());
    copy(plain.z, vendor.z());
  }
};
template <> struct FieldMap<msg::Vector3> {
  using Vendor = geometry_msgs::msg::dds_::Vector3_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.x, vendor.x());
    copy(plain.y, vendor.y());
    copy(plain.z, vendor.z());
  }
};
template <> struct FieldMap<msg::Quaternion> {
  using Vendor = geometry_msgs::msg::dds_::Quaternion_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.x, vendor.x());
    copy(plain.y, vendor.y());
    copy(plain.z, vendor.z());
    copy(plain.w, vendor.w());
  }
};
template <> struct FieldMap<msg::Pose> {
  using Vendor = geometry_msgs::msg::dds_::Pose_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.position, vendor.position());
    copy(plain.orientation, vendor.orientation());
  }
};
template <> struct FieldMap<msg::PoseStamped> {
  using Vendor = geometry_msgs::msg::dds_::PoseStamped_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.pose, vendor.pose());
  }
};
template <> struct FieldMap<msg::PoseWithCovariance> {
  using Vendor = geometry_msgs::msg::dds_::PoseWithCovariance_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.pose, vendor.pose());
    copy(plain.covariance, vendor.covariance());
  }
};
template <> struct FieldMap<msg::Twist> {
  using Vendor = geometry_msgs::msg::dds_::Twist_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.linear, vendor.linear());
    copy(plain.angular, vendor.angular());
  }
};
template <> struct FieldMap<msg::TwistWithCovariance> {
  using Vendor = geometry_msgs::msg::dds_::TwistWithCovariance_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.twist, vendor.twist());
    copy(plain.covariance, vendor.covariance());
  }
};
template <> struct FieldMap<msg::RosTransform> {
  using Vendor = geometry_msgs::msg::dds_::Transform_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.translation, vendor.translation());
    copy(plain.rotation, vendor.rotation());
  }
};
template <> struct FieldMap<msg::TransformStamped> {
  using Vendor = geometry_msgs::msg::dds_::TransformStamped_;
  static void pair(auto& plain, auto& vendor, auto copy) {
    copy(plain.header, vendor.header());
    copy(plain.child_frame_id, vendor.child_frame_id());
    copy(plain.transform, vendor.transform());
  }
};
// clang-format on

}  // namespace rtd::bus::fastdds
