// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"

namespace rtd::msg {

/// x y z in metres and one more channel, 32 bits each: "intensity", or "rgb" as packed bytes.
using CloudSlot = std::array<float, 4>;

/// An unordered cloud as ROS 2 programs read it, little-endian.
inline PointCloud2 make_cloud(const std::vector<CloudSlot>& slots, const std::string& channel, std::int64_t stamp_ns,
                              const std::string& frame) {
  constexpr std::uint8_t kFloat32 = 7;  // sensor_msgs/PointField
  PointCloud2 cloud;
  cloud.header = {to_time(stamp_ns), frame};
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(slots.size());
  cloud.fields = {{"x", 0, kFloat32, 1}, {"y", 4, kFloat32, 1}, {"z", 8, kFloat32, 1}, {channel, 12, kFloat32, 1}};
  cloud.point_step = sizeof(CloudSlot);
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(cloud.row_step);
  if (!slots.empty()) std::memcpy(cloud.data.data(), slots.data(), cloud.data.size());
  return cloud;
}

}  // namespace rtd::msg
