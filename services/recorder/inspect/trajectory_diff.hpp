// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/trajectory.hpp"

namespace rtd::recordings {

/// What counts as the same pose. The trajectories are not aligned.
struct PoseTolerance {
  double stamp_s = 1e-4;  ///< poses whose stamps are at most this far apart form a pair
  double translation_m = 0, rotation_deg = 0;
};

struct PoseDifference {
  std::int64_t stamp_ns = 0;  ///< of A
  double translation_m = 0, rotation_deg = 0;
};

struct TrajectoryDiff {
  std::size_t poses_a = 0, poses_b = 0;
  std::size_t pairs = 0, differing = 0;
  std::vector<std::int64_t> only_a_ns, only_b_ns;  ///< stamps without a partner
  std::optional<PoseDifference> first, largest_translation, largest_rotation;

  bool equal() const { return differing == 0 && only_a_ns.empty() && only_b_ns.empty(); }
};

TrajectoryDiff diff(const geometry::Trajectory& a, const geometry::Trajectory& b, const PoseTolerance& tolerance = {});

std::string to_text(const TrajectoryDiff& diff);
nlohmann::ordered_json to_json(const TrajectoryDiff& diff);

}  // namespace rtd::recordings
