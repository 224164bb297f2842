// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <string>

#include "common/msg/ros.hpp"
#include "common/occupancy/navigation_grid.hpp"

namespace rtd::occupancy {

/// A floor plan as ROS 2 has it, in frame `map_frame`.
msg::OccupancyGrid make_grid(const NavigationGrid& grid, const Eigen::Matrix3d& R_grid_map, std::int64_t stamp_ns,
                             const std::string& map_frame);

/// A floor plan of a robot, and where its frame is in that of all.
struct PlacedPlan {
  Eigen::Isometry3d T_map_robot = Eigen::Isometry3d::Identity();
  const msg::OccupancyGrid* plan = nullptr;
};
/// Several floor plans in one, upright as they are on average and with the finest of their cells. What one has as
/// occupied is occupied, what one has as free is free unless it is. Those whose place cannot be are left out.
msg::OccupancyGrid join_plans(std::span<const PlacedPlan> plans, std::int64_t stamp_ns, const std::string& map_frame);

}  // namespace rtd::occupancy
