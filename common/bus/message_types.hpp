// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::bus {

/// Every message type that the bus carries.
enum class MessageId : std::uint8_t {
  kRgbdFrame,
  kFeatureFrame,
  kKeyframeEvent,
  kTrackingResult,
  kServiceStatus,
  kCompressedImage,
  kImage,
  kCameraInfo,
  kDetection2DArray,
  kOdometry,
  kPoseStamped,
  kTFMessage,
  kPath,
  kPointCloud2,
  kDiagnosticArray
};

/// kPlain: of fixed size, the same bytes in memory as on the wire, so it can be loaned.
template <class T>
struct MessageTraits;

template <MessageId Id, bool Plain>
struct MessageTraitsBase {
  static constexpr MessageId kId = Id;
  static constexpr bool kPlain = Plain;
};

template <>
struct MessageTraits<msg::RgbdFrame> : MessageTraitsBase<MessageId::kRgbdFrame, true> {};
template <>
struct MessageTraits<msg::FeatureFrame> : MessageTraitsBase<MessageId::kFeatureFrame, true> {};
template <>
struct MessageTraits<msg::KeyframeEvent> : MessageTraitsBase<MessageId::kKeyframeEvent, true> {};
template <>
struct MessageTraits<msg::TrackingResult> : MessageTraitsBase<MessageId::kTrackingResult, true> {};
template <>
struct MessageTraits<msg::ServiceStatus> : MessageTraitsBase<MessageId::kServiceStatus, false> {};
template <>
struct MessageTraits<msg::CompressedImage> : MessageTraitsBase<MessageId::kCompressedImage, false> {};
template <>
struct MessageTraits<msg::Image> : MessageTraitsBase<MessageId::kImage, false> {};
template <>
struct MessageTraits<msg::CameraInfo> : MessageTraitsBase<MessageId::kCameraInfo, false> {};
template <>
struct MessageTraits<msg::Detection2DArray> : MessageTraitsBase<MessageId::kDetection2DArray, false> {};
template <>
struct MessageTraits<msg::Odometry> : MessageTraitsBase<MessageId::kOdometry, false> {};
template <>
struct MessageTraits<msg::PoseStamped> : MessageTraitsBase<MessageId::kPoseStamped, false> {};
template <>
struct MessageTraits<msg::TFMessage> : MessageTraitsBase<MessageId::kTFMessage, false> {};
template <>
struct MessageTraits<msg::Path> : MessageTraitsBase<MessageId::kPath, false> {};
template <>
struct MessageTraits<msg::PointCloud2> : MessageTraitsBase<MessageId::kPointCloud2, false> {};
template <>
struct MessageTraits<msg::DiagnosticArray> : MessageTraitsBase<MessageId::kDiagnosticArray, false> {};

}  // namespace rtd::bus
