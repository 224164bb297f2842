// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {

struct DriftOptions {
  double window_s = 1.0 / 3;  ///< ten frames of a camera at 30 Hz
  double least_m = 0.03;      ///< windows with a smaller error say nothing
  double offset_s = 0;        ///< added to the stamps of the estimate
  double scale = 1;           ///< applied to the estimate's translations (Sim(3) alignment)
};

/// How a trajectory drifts where it does: metres, degrees, and their quotient. A pose that follows something near pays
/// for its sideways movement with a turn that keeps what is far away in place; the quotient is then its distance.
/// docs/evaluation.md, "Drift". NaN where there are no windows.
struct Drift {
  std::size_t windows = 0;  ///< whose error is at least DriftOptions::least_m
  double median_m = std::numeric_limits<double>::quiet_NaN();
  double median_rad = std::numeric_limits<double>::quiet_NaN();
  double quotient_m_per_rad = std::numeric_limits<double>::quiet_NaN();  ///< median
  double lower_quartile_m_per_rad = std::numeric_limits<double>::quiet_NaN();
  double upper_quartile_m_per_rad = std::numeric_limits<double>::quiet_NaN();

  /// At least eight windows, and both quartiles within 15 % of the median.
  bool nearly_constant() const;
};

Drift measure_drift(const Trajectory& estimate, const Trajectory& groundtruth, const DriftOptions& options = {});

/// What a nearly constant quotient means, one sentence; empty for any other. With the depth of the scene it says
/// whether that is what stays in place.
std::string explain(const Drift& drift, const std::optional<double>& scene_depth_m = std::nullopt);

}  // namespace rtd::eval
