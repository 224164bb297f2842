// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#include "common/bus/fastdds/field_maps_ros.hpp"
#include "common/bus/fastdds/field_maps_rtd.hpp"

namespace rtd::bus::fastdds {

/// The generated type support of a message that is converted.
template <class T>
struct ConvertedType;

// clang-format off
template <> struct ConvertedType<msg::ServiceStatus> { using PubSub = rtd_msgs::msg::dds_::ServiceStatus_PubSubType; };
template <> struct ConvertedType<msg::CompressedImage> { using PubSub = sensor_msgs::msg::dds_::CompressedImage_PubSubType; };
template <> struct ConvertedType<msg::Image> { using PubSub = sensor_msgs::msg::dds_::Image_PubSubType; };
template <> struct ConvertedType<msg::CameraInfo> { using PubSub = sensor_msgs::msg::dds_::CameraInfo_PubSubType; };
template <> struct ConvertedType<msg::PointCloud2> { using PubSub = sensor_msgs::msg::dds_::PointCloud2_PubSubType; };
template <> struct ConvertedType<msg::Detection2DArray> { using PubSub = vision_msgs::msg::dds_::Detection2DArray_PubSubType; };
template <> struct ConvertedType<msg::Odometry> { using PubSub = nav_msgs::msg::dds_::Odometry_PubSubType; };
template <> struct ConvertedType<msg::Path> { using PubSub = nav_msgs::msg::dds_::Path_PubSubType; };
template <> struct ConvertedType<msg::PoseStamped> { using PubSub = geometry_msgs::msg::dds_::PoseStamped_PubSubType; };
template <> struct ConvertedType<msg::TFMessage> { using PubSub = tf2_msgs::msg::dds_::TFMessage_PubSubType; };
template <> struct ConvertedType<msg::DiagnosticArray> { using PubSub = diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType; };
// clang-format on

/// The same, but a malformed sample from outside is refused instead of ending the process: the generated code lets the
/// exceptions of an absurd sequence length through.
template <class T>
class SafeType : public ConvertedType<T>::PubSub {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    try {
      return ConvertedType<T>::PubSub::deserialize(payload, data);
    } catch (const std::exception&) {
      return false;
    }
  }
};

}  // namespace rtd::bus::fastdds
