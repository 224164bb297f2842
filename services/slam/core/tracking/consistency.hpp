// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/se3.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// How well one camera motion explains what is seen, over the last half second. A pose that follows something that
/// moves has as many inliers as a good one, and their covariance is as small; but more of the matched landmarks
/// contradict it, and those that agree do so less closely. docs/theory/tracking.md, "Consistency". Deterministic. Not
/// thread-safe.
class Consistency {
 public:
  explicit Consistency(const ConsistencyConfig& config) : config_(config) {}

  /// One tracked frame, `elapsed_s` after the one before.
  void add(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking, double elapsed_s);
  /// 1: everything that was matched agrees; below ConsistencyConfig::doubtful_below the pose is doubtful.
  double value() const { return value_; }
  /// Whether the last frame's pose is doubtful: value() is below doubtful_below, or its standard deviation (m, along
  /// the worst axis), the larger the less agrees, exceeds 2 cm. Eq. (18). Doubt ends a tenth beyond both limits.
  /// To be asked once for each frame.
  bool doubts(double sigma_m);
  /// What the contradictions add to the covariance of a pose, (x y z rx ry rz), in a scene at `scene_m`. Eq. (17).
  geometry::Matrix6d covariance(double scene_m) const;
  /// Another place: nothing is known of it.
  void reset();

 private:
  ConsistencyConfig config_;
  double value_ = kStart;
  bool contradicted_ = false, uncertain_ = false;

  static constexpr double kStart = 0.75;  ///< usual for a camera among people
};

}  // namespace rtd::slam
