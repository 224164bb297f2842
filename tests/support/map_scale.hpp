// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/support/walk_world.hpp"

namespace rtd::test_support {

enum class WalkPath : std::uint8_t { kAisles, kRoom };

struct MapScaleOptions {
  WalkPath path = WalkPath::kAisles;
  std::size_t keyframes = 10000;  ///< aisles: in the map at the end; room: insertions
  /// Apart from the first and the last `full_mapping` insertions the mapper is interrupted, as on a busy
  /// host: fusion and adjustment are left out, and a large map is ready sooner. Default: no shortcut.
  std::size_t full_mapping = std::numeric_limits<std::size_t>::max();
  std::size_t compared_frames = 300;  ///< tracked with the small and the large map in turn
  WalkWorld::Options world;
  slam::SlamConfig slam = plain();
  slam::Clock now_ns;                            ///< CPU time of this thread: what else the host does counts little
  std::function<std::int64_t()> allocations;     ///< counts up, of this process; may be empty
  std::function<void(std::size_t)> on_keyframe;  ///< insertions so far; may be empty
};

/// Costs of tracked frames, insertions and snapshots, ns each.
struct MapScaleCosts {
  std::vector<std::int64_t> tracking, insertion, snapshot;
  std::vector<std::int64_t> allocations;  ///< of memory, by each tracked frame
};

struct MapScaleReport {
  MapScaleCosts small, large;  ///< at 100 keyframes and at the end, measured in turn
  std::size_t frames = 0, lost_frames = 0;
  std::size_t insertions = 0, keyframes = 0, landmarks = 0, observations = 0, features = 0;  ///< at the end
  double max_error_m = 0;                             ///< of a frame's motion since the frame before
  std::int64_t trajectory_ns = 0, map_points_ns = 0;  ///< to read all of the final map
  std::string broken_invariant;
};

/// Walks through a world with the real tracker and mapper, without transport, until the map is that large; then
/// continues in turn with a second map of 100 keyframes, so that both meet the same moods of the host.
MapScaleReport run_map_scale(const MapScaleOptions& options);

std::int64_t median(std::vector<std::int64_t> values);  ///< 0 of none

}  // namespace rtd::test_support
