// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// l = log(p / (1 - p)): independent pieces of evidence add up, 0 means "as likely as not".
inline float log_odds(double probability) {
  constexpr double kNearlyCertain = 1e-6;
  const double p = std::clamp(probability, kNearlyCertain, 1 - kNearlyCertain);
  return static_cast<float>(std::log(p / (1 - p)));
}

inline float probability(float log_odds) {
  return 1.0F / (1.0F + std::exp(-log_odds));
}

/// Per cell the log-odds that its surface is static; kNoBelief where nothing is known about it.
using CellBeliefs = std::vector<float>;
inline constexpr float kNoBelief = 1e9F;
inline bool is_known(float belief) {
  return belief < kNoBelief;
}

/// The beliefs about the surfaces of the last frame, carried to the current one. A belief is attached to a place in
/// space: what steps in front of a wall does not inherit the wall's belief, and the wall keeps it whatever a detector
/// calls it.
class SurfaceBeliefs {
 public:
  void store(const DepthGrid& grid, CellBeliefs beliefs);
  void clear() { beliefs_.clear(); }

  /// Looks up every measured cell of the current frame where `T_last_current` puts it in the last one; the depth there
  /// must agree within `tolerance_m`, at the cell or at one next to it. `rays`: viewing rays of the cells at z = 1.
  /// `where`, if given: only cells that are not 0 there.
  CellBeliefs recall(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                     const geometry::CameraModel& camera, const Eigen::Isometry3d& T_last_current,
                     const CellMask* where = nullptr, float tolerance_m = kOwnDepthM) const;

  static constexpr float kOwnDepthM = 0.15F;

 private:
  float near(int cell, float depth_m, float tolerance_m) const;

  GridShape shape_;
  std::vector<float> depth_m_;
  CellBeliefs beliefs_;
};

}  // namespace rtd::filter
