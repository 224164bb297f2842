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

/// One drawing for `rtd eval --plot`: path coloured by error, error over time, numbers in the title.
std::string evaluation_svg(const AteResult& ate, const Trajectory& groundtruth, const std::string& title);

/// An estimate of several, under its name in the legend.
struct NamedAte {
  std::string name;
  const AteResult* ate;
};

/// The same for several estimates of one ground truth: a colour for each.
std::string comparison_svg(const std::vector<NamedAte>& estimates, const Trajectory& groundtruth);

}  // namespace rtd::eval
