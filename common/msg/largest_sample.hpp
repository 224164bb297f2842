// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <type_traits>

#include "common/msg/fields.hpp"

/// How large a sample on the bus may be, its CDR header included. What common/msg/field_rules.hpp says about single
/// fields is no such limit: a message in which all of them are at their largest is never sent. Both vendors refuse a
/// larger sample before they take memory for it, and our writers do not write it.
namespace rtd::msg {

inline constexpr std::size_t kKib = 1024, kMib = 1024 * kKib;

/// Of a topic of another program whose type we do not know, or of which only memory limits the size: images, clouds.
inline constexpr std::size_t kLargestOfOthers = 64 * kMib;
/// Of a type of variable size without an entry.
inline constexpr std::size_t kLargestSmallSample = 64 * kKib;

struct SampleLimit {
  std::string_view type;  ///< "package/Type"
  std::size_t bytes;
};

inline constexpr SampleLimit kLargestSamples[] = {
    {"sensor_msgs/CompressedImage", 8 * kMib},  // 1920x1200 pixels of noise, at the best quality
    {"sensor_msgs/Image", kMib},                // a mask has a pixel for 4x4 of the camera's
    {"sensor_msgs/PointCloud2", 16 * kMib},     // a million points
    {"nav_msgs/OccupancyGrid", 16 * kMib},      // dense.grid.max_cells
    {"nav_msgs/Path", 4 * kMib},                // 30,000 poses
    {"rtd_msgs/MapUpdate", 2 * kMib},
    {"rtd_msgs/Movers", kMib},
    {"rtd_msgs/KeyframeFeatures", 512 * kKib},
    {"rtd_msgs/Submap", 4 * kMib},
    {"vision_msgs/Detection2DArray", kMib},
    {"vision_msgs/Detection3DArray", kMib},
    {"visualization_msgs/MarkerArray", kMib},
    {"tf2_msgs/TFMessage", kMib},
    {"diagnostic_msgs/DiagnosticArray", kMib},
};

/// Of a type of variable size.
constexpr std::size_t largest_sample(std::string_view type) {
  for (const SampleLimit& limit : kLargestSamples)
    if (limit.type == type) return limit.bytes;
  return kLargestSmallSample;
}

template <Message T>
constexpr std::size_t largest_sample() {
  constexpr std::size_t kCdrHeader = 4;
  return std::is_trivially_copyable_v<T> ? kCdrHeader + sizeof(T) : largest_sample(type_name(TypeOf<T>()));
}

}  // namespace rtd::msg
