// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/core/plot/chart.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {

inline constexpr double kMaxGapS = 0.5;  ///< longer times without poses interrupt a line

/// A length unit that gives readable numbers.
struct LengthUnit {
  const char* name;  ///< "mm", "cm" or "m"
  double per_metre;
};
LengthUnit length_unit(double largest_m);

/// "1.23 cm": a length in its readable unit, "unknown" when not finite.
std::string length_text(double length_m);

/// The two world axes along which a path extends most; a path is drawn by its projection on them.
struct PlaneView {
  int horizontal = 0, vertical = 1;  ///< 0 x, 1 y, 2 z
};
PlaneView widest_plane(const std::vector<Eigen::Vector3d>& points_m);

/// A path to draw without errors.
struct PathCurve {
  std::string label, colour;
  std::vector<std::int64_t> stamps_ns;
  std::vector<Eigen::Vector3d> points_m;
  plot::Stroke stroke;  ///< its colour is replaced by `colour`
};

PathCurve path_of(const Trajectory& trajectory);
/// The poses from first_ns to last_ns.
Trajectory within(const Trajectory& trajectory, std::int64_t first_ns, std::int64_t last_ns);

/// Height of a drawing of this width that the paths fill at equal aspect, within limits.
double fitting_height(const std::vector<PathCurve>& curves, double width);

/// The estimate coloured by its error over the grey ground truth, equal aspect, colour scale at the right.
void draw_error_path(plot::Svg& svg, const plot::Area& area, const AteResult& ate, const Trajectory& groundtruth);

/// Paths in one frame, equal aspect, with a legend; `plane` is chosen from the first one.
void draw_paths(plot::Svg& svg, const plot::Area& area, const std::vector<PathCurve>& curves);

/// One error curve over time.
struct ErrorCurve {
  std::string label, colour;
  const AteResult* ate = nullptr;
};
/// Position errors over seconds since start_ns, with a line at each RMSE.
void draw_errors_over_time(plot::Svg& svg, const plot::Area& area, const std::vector<ErrorCurve>& curves,
                           std::int64_t start_ns, double duration_s);

/// One drawing for `rtd eval --plot`: path coloured by error, error over time, numbers in the title.
std::string evaluation_svg(const AteResult& ate, const Trajectory& groundtruth, const std::string& title);

}  // namespace rtd::eval
