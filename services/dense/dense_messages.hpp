// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"
#include "services/dense/core/depth_view.hpp"
#include "services/dense/core/navigation_grid.hpp"
#include "services/dense/core/point_cloud.hpp"

namespace rtd::dense {

/// The filter's mask of what moves; empty when encoding, size or length is wrong.
std::optional<DynamicMask> from_message(const msg::Image& message);

/// x y z and rgb (packed as usual in ROS), all float32.
msg::PointCloud2 make_cloud(const std::vector<CloudPoint>& points, std::int64_t stamp_ns, const std::string& map_frame);

/// A floor plan; its origin also says how `grid` is turned in the map.
msg::OccupancyGrid make_grid(const NavigationGrid& grid, const Eigen::Matrix3d& R_grid_map, std::int64_t stamp_ns,
                             const std::string& map_frame);

}  // namespace rtd::dense
