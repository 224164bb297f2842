// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/trajectory_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "services/evaluation/core/plot/chart.hpp"

namespace rtd::eval {
namespace {

using plot::Area;
using plot::Chart;
using plot::Point;
namespace palette = plot::palette;

constexpr std::size_t kMaxPathPoints = 4000;
constexpr std::array<const char*, 3> kAxisNames{"x [m]", "y [m]", "z [m]"};

constexpr double kMaxGapS = 0.5;  // longer times without poses interrupt a line

/// A length unit that gives readable numbers.
struct LengthUnit {
  const char* name;
  double per_metre;
};

LengthUnit length_unit(double largest_m) {
  if (largest_m < 0.02) return {"mm", 1000};
  if (largest_m < 1.0) return {"cm", 100};
  return {"m", 1};
}

/// What `value_of` gives for each.
std::vector<double> each(const auto& items, const auto& value_of) {
  std::vector<double> values;
  for (const auto& item : items) values.push_back(value_of(item));
  return values;
}

plot::Range range_along(const std::vector<Eigen::Vector3d>& points_m, int axis) {
  return plot::range_of(each(points_m, [axis](const Eigen::Vector3d& p) { return p[axis]; }));
}

/// The two world axes along which a path extends most; a path is drawn by its projection on them.
struct PlaneView {
  int horizontal = 0, vertical = 1;  ///< 0 x, 1 y, 2 z
};

PlaneView widest_plane(const std::vector<Eigen::Vector3d>& points_m) {
  std::array<int, 3> axes{0, 1, 2};
  std::ranges::stable_sort(
      axes, [&](int a, int b) { return range_along(points_m, a).span() > range_along(points_m, b).span(); });
  return {axes[0], axes[1]};
}

/// A path to draw without errors.
struct PathCurve {
  std::vector<std::int64_t> stamps_ns;
  std::vector<Eigen::Vector3d> points_m;
  plot::Stroke stroke;
};

PathCurve path_of(const Trajectory& trajectory) {
  PathCurve curve;
  curve.stamps_ns = stamps_of(trajectory);
  for (const StampedPose& pose : trajectory) curve.points_m.push_back(pose.T_world_body.translation());
  return curve;
}

plot::Range padded(const plot::Range& range) {
  const double margin = 0.05 * range.span();
  return {range.min - margin, range.max + margin};
}

Chart path_chart(plot::Svg& svg, const Area& area, const std::vector<Eigen::Vector3d>& all_m, PlaneView plane) {
  Chart chart = Chart::equal_aspect(svg, area, padded(range_along(all_m, plane.horizontal)),
                                    padded(range_along(all_m, plane.vertical)));
  chart.draw_axes(
      {kAxisNames[static_cast<std::size_t>(plane.horizontal)], kAxisNames[static_cast<std::size_t>(plane.vertical)]});
  return chart;
}

/// Draws a path, interrupted where it has no poses and thinned to what a picture can show.
void draw_path(plot::Svg& svg, const Chart& chart, const PathCurve& curve, PlaneView plane) {
  const std::size_t stride = curve.points_m.size() / kMaxPathPoints + 1;
  std::vector<Point> run;
  std::int64_t before_ns = 0;
  for (std::size_t i = 0; i < curve.points_m.size(); i += stride) {
    if (!run.empty() && seconds(curve.stamps_ns[i] - before_ns) > kMaxGapS * static_cast<double>(stride)) {
      svg.polyline(run, curve.stroke);
      run.clear();
    }
    run.push_back(chart.at(curve.points_m[i][plane.horizontal], curve.points_m[i][plane.vertical]));
    before_ns = curve.stamps_ns[i];
  }
  if (!run.empty()) svg.polyline(run, curve.stroke);
}

/// Colours of several estimates; when they come again, dashed.
plot::Stroke stroke_of(std::size_t place) {
  constexpr std::array kColours{palette::kBlue, palette::kAmber, palette::kGreen, "#b03a5b", "#7a52a8", "#3aa6b8"};
  return {kColours[place % kColours.size()], 1.8, place < kColours.size() ? "" : "5 3"};
}

void draw_errors_of_all(plot::Svg& svg, const Area& frame, const std::vector<NamedAte>& estimates, double max_m) {
  std::int64_t first_ns = INT64_MAX, last_ns = INT64_MIN;
  for (const auto& [name, ate] : estimates) {
    if (ate->points.empty()) continue;
    first_ns = std::min(first_ns, ate->points.front().stamp_ns);
    last_ns = std::max(last_ns, ate->points.back().stamp_ns);
  }
  const LengthUnit unit = length_unit(max_m);
  Chart chart(svg, frame, {0, std::max(seconds(last_ns - first_ns), 1e-3)}, {0, max_m * unit.per_metre * 1.06});
  chart.draw_axes({"time since the first frame [s]", fmt::format("position error [{}]", unit.name)});
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const std::vector<AtePoint>& points = estimates[i].ate->points;
    chart.curve(each(points, [&](const AtePoint& p) { return seconds(p.stamp_ns - first_ns); }),
                each(points, [&](const AtePoint& p) { return p.error_m * unit.per_metre; }), stroke_of(i), kMaxGapS);
  }
}

}  // namespace

std::string length_text(double length_m) {
  if (!std::isfinite(length_m)) return "unknown";
  const LengthUnit unit = length_unit(length_m);
  return fmt::format("{:.2f} {}", length_m * unit.per_metre, unit.name);
}

Trajectory within(const Trajectory& trajectory, std::int64_t first_ns, std::int64_t last_ns) {
  Trajectory part;
  std::ranges::copy_if(trajectory, std::back_inserter(part),
                       [&](const StampedPose& p) { return p.stamp_ns >= first_ns && p.stamp_ns <= last_ns; });
  return part;
}

std::string evaluation_svg(const std::vector<NamedAte>& estimates, const Trajectory& groundtruth) {
  std::vector<PathCurve> curves{path_of(groundtruth)};
  curves.front().stroke = {palette::kTruth, 2.2};
  std::vector<Eigen::Vector3d> all_m = curves.front().points_m;
  std::vector<plot::LegendEntry> legend{{"ground truth", palette::kTruth}};
  double max_m = 1e-6;
  for (const auto& [name, ate] : estimates) {
    PathCurve curve{.stroke = stroke_of(curves.size() - 1)};
    for (const AtePoint& point : ate->points) {
      curve.stamps_ns.push_back(point.stamp_ns);
      curve.points_m.push_back(point.estimate_m);
      max_m = std::max(max_m, point.error_m);
    }
    all_m.insert(all_m.end(), curve.points_m.begin(), curve.points_m.end());
    legend.push_back({fmt::format("{}: ATE RMSE {}", name, length_text(ate->error_m.rmse)), curve.stroke.colour});
    curves.push_back(std::move(curve));
  }
  const double top = 20 + 18 * static_cast<double>(legend.size());
  plot::Svg svg(900, top + 890, "Trajectories and their errors");
  for (std::size_t i = 0; i < legend.size(); ++i)
    plot::draw_legend(svg, {20, 24 + 18 * static_cast<double>(i)}, {legend[i]});
  const PlaneView plane = widest_plane(all_m);
  const Chart paths = path_chart(svg, {68, top + 20, 800, 540}, all_m, plane);
  for (const PathCurve& curve : curves) draw_path(svg, paths, curve, plane);
  draw_errors_of_all(svg, {68, top + 630, 800, 210}, estimates, max_m);
  return svg.document();
}

}  // namespace rtd::eval
