// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/type_names.hpp"

#include <string>

#include "common/bus/backend.hpp"

namespace rtd::bus {

const char* dds_type_name(MessageId id) {
  // clang-format off
  switch (id) {
    case MessageId::kRgbdFrame:        return "rtd_msgs::msg::dds_::RgbdFrame_";
    case MessageId::kFeatureFrame:     return "rtd_msgs::msg::dds_::FeatureFrame_";
    case MessageId::kKeyframeEvent:    return "rtd_msgs::msg::dds_::KeyframeEvent_";
    case MessageId::kTrackingResult:   return "rtd_msgs::msg::dds_::TrackingResult_";
    case MessageId::kServiceStatus:    return "rtd_msgs::msg::dds_::ServiceStatus_";
    case MessageId::kCompressedImage:  return "sensor_msgs::msg::dds_::CompressedImage_";
    case MessageId::kImage:            return "sensor_msgs::msg::dds_::Image_";
    case MessageId::kCameraInfo:       return "sensor_msgs::msg::dds_::CameraInfo_";
    case MessageId::kDetection2DArray: return "vision_msgs::msg::dds_::Detection2DArray_";
    case MessageId::kOdometry:         return "nav_msgs::msg::dds_::Odometry_";
    case MessageId::kPoseStamped:      return "geometry_msgs::msg::dds_::PoseStamped_";
    case MessageId::kTFMessage:        return "tf2_msgs::msg::dds_::TFMessage_";
    case MessageId::kPath:             return "nav_msgs::msg::dds_::Path_";
    case MessageId::kPointCloud2:      return "sensor_msgs::msg::dds_::PointCloud2_";
    case MessageId::kDiagnosticArray:  return "diagnostic_msgs::msg::dds_::DiagnosticArray_";
  }
  // clang-format on
  throw BusError("message id " + std::to_string(static_cast<int>(id)) + " is not one of common/bus/message_types.hpp");
}

}  // namespace rtd::bus
