// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/msg/ros.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::atlas {

/// The newest floor plan of each robot, as its rtd-dense publishes it, and all of them in one. Not thread-safe.
class FloorPlans {
 public:
  void take(const std::string& robot, std::shared_ptr<const msg::OccupancyGrid> plan) {
    plans_[robot] = std::move(plan);
  }
  void forget(const std::string& robot) { plans_.erase(robot); }
  /// Those of robots with a place; empty when nothing has changed since.
  std::optional<msg::OccupancyGrid> join(const std::map<std::string, msg::Transform>& T_map_robots,
                                         std::int64_t stamp_ns, const std::string& map_frame);

 private:
  using Placed = std::pair<std::shared_ptr<const msg::OccupancyGrid>, std::array<double, 7>>;
  std::map<std::string, std::shared_ptr<const msg::OccupancyGrid>> plans_;
  std::map<std::string, Placed> joined_;  ///< of the last time
};

}  // namespace rtd::atlas
