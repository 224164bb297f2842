// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {

/// "1.23 cm": a length in its readable unit, "unknown" when not finite.
std::string length_text(double length_m);

/// The poses from first_ns to last_ns.
Trajectory within(const Trajectory& trajectory, std::int64_t first_ns, std::int64_t last_ns);

/// An estimate, under its name in the legend.
struct NamedAte {
  std::string name;
  const AteResult* ate;
};

/// One drawing for `rtd eval --plot`: the paths and their errors over time, a colour for each estimate.
std::string evaluation_svg(const std::vector<NamedAte>& estimates, const Trajectory& groundtruth);

}  // namespace rtd::eval
