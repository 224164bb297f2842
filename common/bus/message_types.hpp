// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "common/msg/features.hpp"
#include "common/msg/map_update.hpp"
#include "common/msg/movers.hpp"
#include "common/msg/rgbd_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/msg/status.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::bus {

template <class... T>
struct TypeList {};

/// Every message type that the bus carries.
using MessageTypes = TypeList<msg::RgbdFrame, msg::RgbdFrame848, msg::RgbdFrame1280, msg::RgbdFrame1920,
                              msg::FeatureFrame, msg::KeyframeEvent, msg::TrackingResult, msg::ServiceStatus,
                              msg::CompressedImage, msg::Image, msg::CameraInfo, msg::Detection2DArray, msg::Odometry,
                              msg::PoseStamped, msg::TFMessage, msg::Path, msg::PointCloud2, msg::DiagnosticArray,
                              msg::MapUpdate, msg::Movers, msg::Detection3DArray, msg::MarkerArray, msg::OccupancyGrid>;

/// The place of a type in the list.
enum class MessageId : std::uint8_t {};

template <class T, class... All>
consteval MessageId place_in(TypeList<All...>) {
  static_assert((std::same_as<T, All> || ...), "not one of MessageTypes");
  std::uint8_t place = 0;
  (void)((std::same_as<T, All> || (++place, false)) || ...);
  return MessageId{place};
}

template <class T>
struct MessageTraits {
  static constexpr MessageId kId = place_in<T>(MessageTypes());
  /// Of fixed size, the same bytes in memory as on the wire, so it can be loaned.
  static constexpr bool kPlain = std::is_trivially_copyable_v<T>;
};

}  // namespace rtd::bus
