// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "common/bus/backend.hpp"

namespace rtd::bus {

/// Calls visitor.operator()<T>() with the plain struct T that belongs to `id`: the way from a run-time id back to a
/// type.
template <class Visitor>
decltype(auto) visit_message_type(MessageId id, Visitor&& visitor) {
  switch (id) {
    case MessageId::kRgbdFrame:
      return visitor.template operator()<msg::RgbdFrame>();
    case MessageId::kFeatureFrame:
      return visitor.template operator()<msg::FeatureFrame>();
    case MessageId::kKeyframeEvent:
      return visitor.template operator()<msg::KeyframeEvent>();
    case MessageId::kTrackingResult:
      return visitor.template operator()<msg::TrackingResult>();
    case MessageId::kServiceStatus:
      return visitor.template operator()<msg::ServiceStatus>();
    case MessageId::kCompressedImage:
      return visitor.template operator()<msg::CompressedImage>();
    case MessageId::kImage:
      return visitor.template operator()<msg::Image>();
    case MessageId::kCameraInfo:
      return visitor.template operator()<msg::CameraInfo>();
    case MessageId::kDetection2DArray:
      return visitor.template operator()<msg::Detection2DArray>();
    case MessageId::kOdometry:
      return visitor.template operator()<msg::Odometry>();
    case MessageId::kPoseStamped:
      return visitor.template operator()<msg::PoseStamped>();
    case MessageId::kTFMessage:
      return visitor.template operator()<msg::TFMessage>();
    case MessageId::kPath:
      return visitor.template operator()<msg::Path>();
    case MessageId::kPointCloud2:
      return visitor.template operator()<msg::PointCloud2>();
    case MessageId::kDiagnosticArray:
      return visitor.template operator()<msg::DiagnosticArray>();
  }
  throw BusError("message id " + std::to_string(static_cast<int>(id)) + " is not one of common/bus/message_types.hpp");
}

}  // namespace rtd::bus
