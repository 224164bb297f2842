// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/dense_messages.hpp"

#include <array>
#include <cstring>

namespace rtd::dense {
namespace {

constexpr std::uint8_t kFloat32 = 7;  // sensor_msgs/PointField
constexpr std::uint32_t kMaxSide = 4096;

}  // namespace

std::optional<DynamicMask> from_message(const msg::Image& message) {
  const bool sane = message.encoding == "mono8" && message.width > 0 && message.height > 0 &&
                    message.width <= kMaxSide && message.height <= kMaxSide && message.step >= message.width &&
                    message.data.size() >= std::size_t{message.step} * message.height;
  if (!sane) return std::nullopt;
  DynamicMask mask{static_cast<int>(message.width), static_cast<int>(message.height), {}};
  for (std::uint32_t row = 0; row < message.height; ++row) {
    const auto first = message.data.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * message.step);
    mask.cells.insert(mask.cells.end(), first, first + message.width);
  }
  return mask;
}

msg::PointCloud2 make_cloud(const std::vector<CloudPoint>& points, std::int64_t stamp_ns,
                            const std::string& map_frame) {
  msg::PointCloud2 cloud;
  cloud.header = {msg::to_time(stamp_ns), map_frame};
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(points.size());
  cloud.fields = {{"x", 0, kFloat32, 1}, {"y", 4, kFloat32, 1}, {"z", 8, kFloat32, 1}, {"rgb", 12, kFloat32, 1}};
  cloud.point_step = 16;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(cloud.row_step);
  std::uint8_t* slot = cloud.data.data();
  for (const CloudPoint& point : points) {
    const std::array<std::uint8_t, 4> bgra{to_byte(point.bgr[0]), to_byte(point.bgr[1]), to_byte(point.bgr[2]), 0};
    std::memcpy(slot, point.p_world.data(), 12);
    std::memcpy(slot + 12, bgra.data(), 4);
    slot += cloud.point_step;
  }
  return cloud;
}

}  // namespace rtd::dense
