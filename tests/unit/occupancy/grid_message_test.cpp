// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/occupancy/grid_message.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rtd::occupancy {
namespace {

constexpr double kCell_m = 0.1;
constexpr int kColumns = 40, kRows = 30;

/// A room of 4 m by 3 m: walls, a free floor, and a cupboard in the corner at the origin. Its map's z is up.
msg::OccupancyGrid room() {
  NavigationGrid grid =
      NavigationGrid::unknown({Eigen::Vector2i(0, 0), Eigen::Vector2i(kColumns - 1, kRows - 1)}, kCell_m, 10'000);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const bool wall = x == 0 || y == 0 || x == kColumns - 1 || y == kRows - 1;
      grid.mark({x, y}, wall || (x < 10 && y < 5) ? NavigationGrid::kOccupied : NavigationGrid::kFree);
    }
  }
  return make_grid(grid, Eigen::Matrix3d::Identity(), 0, "map");
}

/// Of a point of the map, by the message alone.
int value_at(const msg::OccupancyGrid& plan, const Eigen::Vector3d& p_map) {
  const auto& [at, q] = plan.info.origin;
  const Eigen::Isometry3d T_map_corner =
      Eigen::Translation3d(at.x, at.y, at.z) * Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d p = T_map_corner.inverse() * p_map / static_cast<double>(plan.info.resolution);
  if (p.x() < 0 || p.y() < 0 || p.x() >= plan.info.width || p.y() >= plan.info.height) return -1;
  return plan.data[static_cast<std::size_t>(p.y()) * plan.info.width + static_cast<std::size_t>(p.x())];
}

/// Turned by 30 degrees and 6 m away.
Eigen::Isometry3d next_door() {
  return Eigen::Translation3d(6, 1, 0.02) * Eigen::AngleAxisd(std::numbers::pi / 6, Eigen::Vector3d::UnitZ());
}

TEST(JoinPlans, rooms_of_two_robots_are_in_one_plan) {
  const msg::OccupancyGrid plan = room();
  const PlacedPlan plans[] = {{Eigen::Isometry3d::Identity(), &plan}, {next_door(), &plan}};
  const msg::OccupancyGrid joint = join_plans(plans, 5, "map");
  EXPECT_EQ(joint.header.frame_id, "map");
  for (const PlacedPlan& placed : plans) {
    int wrong = 0;
    for (double x = 0.25; x < 3.8;
         x += kCell_m)  // half a cell from each border: no turned cell is on both sides of one
      for (double y = 0.25; y < 2.8; y += kCell_m) {
        const bool at_cupboard = std::abs(x - 1) < 0.1 || std::abs(y - 0.5) < 0.1;
        const bool cupboard = x < 1 && y < 0.5;
        wrong += !at_cupboard && value_at(joint, placed.T_map_robot * Eigen::Vector3d(x, y, 0)) != (cupboard ? 100 : 0);
      }
    EXPECT_EQ(wrong, 0);
    for (double x = 0.05; x < 4; x += kCell_m) {
      int most = 0;
      for (double y = -0.1; y < 0.2; y += 0.005)
        most = std::max(most, value_at(joint, placed.T_map_robot * Eigen::Vector3d(x, y, 0)));
      EXPECT_EQ(most, 100) << "no way through the wall at " << x;
    }
  }
  EXPECT_EQ(value_at(joint, {5, -0.5, 0}), -1) << "between the rooms";
  EXPECT_EQ(value_at(join_plans(std::span(plans, 1), 5, "map"), next_door() * Eigen::Vector3d(2, 1.5, 0)), -1)
      << "without the other";
}

TEST(JoinPlans, what_one_has_as_occupied_is) {
  msg::OccupancyGrid free = room();
  std::ranges::fill(free.data, NavigationGrid::kFree);
  const msg::OccupancyGrid plan = room();
  const PlacedPlan plans[] = {{Eigen::Isometry3d::Identity(), &plan}, {Eigen::Isometry3d::Identity(), &free}};
  EXPECT_EQ(join_plans(plans, 0, "map").data, plan.data);
}

/// A camera's map: y down.
TEST(JoinPlans, the_plan_is_level_in_a_map_that_is_not_upright) {
  const msg::OccupancyGrid plan = room();
  const Eigen::Isometry3d T_map_robot(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  const PlacedPlan plans[] = {{T_map_robot, &plan}};
  const msg::OccupancyGrid joint = join_plans(plans, 0, "map");
  EXPECT_EQ(value_at(joint, T_map_robot * Eigen::Vector3d(2, 1.5, 0)), 0);
  EXPECT_EQ(value_at(joint, T_map_robot * Eigen::Vector3d(0.5, 0.25, 0)), 100);
}

TEST(JoinPlans, plans_that_cannot_be_are_left_out) {
  msg::OccupancyGrid broken[4] = {room(), room(), room(), {}};
  broken[0].info.resolution = 0;
  broken[1].info.origin.orientation = {0, 0, 0, 0};
  broken[2].info.origin.position.x = 1e300;
  for (const msg::OccupancyGrid& plan : broken) {
    const PlacedPlan plans[] = {{Eigen::Isometry3d::Identity(), &plan}};
    EXPECT_TRUE(join_plans(plans, 0, "map").data.empty());
  }
}

}  // namespace
}  // namespace rtd::occupancy
