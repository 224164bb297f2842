// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/dense_messages.hpp"

#include <array>
#include <bit>

#include "common/msg/point_cloud.hpp"

namespace rtd::dense {
namespace {

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
  std::vector<msg::CloudSlot> slots;
  slots.reserve(points.size());
  for (const CloudPoint& point : points) {
    const std::array<std::uint8_t, 4> bgra{to_byte(point.bgr[0]), to_byte(point.bgr[1]), to_byte(point.bgr[2]), 0};
    slots.push_back({point.p_world.x(), point.p_world.y(), point.p_world.z(), std::bit_cast<float>(bgra)});
  }
  return msg::make_cloud(slots, "rgb", stamp_ns, map_frame);
}

msg::OccupancyGrid make_grid(const NavigationGrid& grid, const Eigen::Matrix3d& R_grid_map, std::int64_t stamp_ns,
                             const std::string& map_frame) {
  msg::OccupancyGrid message;
  message.header = {msg::to_time(stamp_ns), map_frame};
  message.info.map_load_time = message.header.stamp;
  message.info.resolution = static_cast<float>(grid.cell_m);
  message.info.width = static_cast<std::uint32_t>(grid.columns);
  message.info.height = static_cast<std::uint32_t>(grid.rows);
  const Eigen::Vector3d corner =
      R_grid_map.transpose() * Eigen::Vector3d(grid.origin_m().x(), grid.origin_m().y(), grid.floor_m);
  const Eigen::Quaterniond q(Eigen::Matrix3d(R_grid_map.transpose()));
  message.info.origin = {{corner.x(), corner.y(), corner.z()}, {q.x(), q.y(), q.z(), q.w()}};
  message.data = grid.cells;
  return message;
}

}  // namespace rtd::dense
