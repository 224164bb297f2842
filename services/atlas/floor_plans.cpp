// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/atlas/floor_plans.hpp"

#include <algorithm>
#include <vector>

#include "common/msg/transform_eigen.hpp"
#include "common/occupancy/grid_message.hpp"

namespace rtd::atlas {

std::optional<msg::OccupancyGrid> FloorPlans::join(const std::map<std::string, msg::Transform>& T_map_robots,
                                                   std::int64_t stamp_ns, const std::string& map_frame) {
  std::map<std::string, Placed> placed;
  std::vector<occupancy::PlacedPlan> plans;
  for (const auto& [robot, plan] : plans_) {
    const auto place = T_map_robots.find(robot);
    if (place == T_map_robots.end()) continue;
    const auto& [t, q] = place->second;
    placed[robot] = {plan, {t[0], t[1], t[2], q[0], q[1], q[2], q[3]}};
    plans.push_back({msg::to_isometry(place->second), plan.get()});
  }
  if (placed == joined_) return std::nullopt;
  joined_ = std::move(placed);
  return occupancy::join_plans(plans, stamp_ns, map_frame);
}

}  // namespace rtd::atlas
