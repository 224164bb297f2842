// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/map_picture.hpp"

#include <algorithm>
#include <sstream>

#include "common/io/text.hpp"
#include "services/evaluation/core/plot/chart.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"

namespace rtd::eval {
namespace {

namespace palette = plot::palette;

constexpr double kPictureWidth = 1080, kLowest = 320, kHighest = 620;

/// From the 2 % to the 98 % quantile, and the path: a few far points must not shrink the room to a dot.
plot::Range extent(const std::vector<Eigen::Vector3d>& landmarks_m, const std::vector<Eigen::Vector3d>& path_m,
                   int axis) {
  std::vector<double> values;
  for (const Eigen::Vector3d& p : landmarks_m) values.push_back(p[axis]);
  std::ranges::sort(values);
  const std::size_t cut = values.size() / 50;
  plot::Range range{values[cut], values[values.size() - 1 - cut]};
  for (const Eigen::Vector3d& p : path_m) {
    range.min = std::min(range.min, p[axis]);
    range.max = std::max(range.max, p[axis]);
  }
  const double margin = std::max(0.05, 0.05 * range.span());
  return {range.min - margin, range.max + margin};
}

}  // namespace

std::vector<Eigen::Vector3d> read_landmarks(std::istream& in, std::size_t most) {
  std::string line;
  std::size_t count = 0;
  bool is_text = false, in_header = true;
  while (in_header && io::get_line(in, line)) {
    std::istringstream words(line);
    std::string key, what;
    words >> key >> what;
    if (key == "format") is_text = what == "ascii";
    if (key == "element" && what == "vertex") words >> count;
    in_header = key != "end_header";
  }
  std::vector<Eigen::Vector3d> points_m;
  if (in_header || !is_text) return points_m;
  const std::size_t stride = count / std::max<std::size_t>(1, most) + 1;
  for (std::size_t i = 0; i < count && io::get_line(in, line); ++i) {
    Eigen::Vector3d p;
    if (i % stride != 0 || !(std::istringstream(line) >> p.x() >> p.y() >> p.z())) continue;
    if (p.allFinite()) points_m.push_back(p);
  }
  return points_m;
}

std::string map_picture(const std::vector<Eigen::Vector3d>& landmarks_m, const Trajectory& estimate) {
  if (landmarks_m.empty()) return "";
  const PathCurve path = path_of(estimate);
  const plot::Range x = extent(landmarks_m, path.points_m, 0), y = extent(landmarks_m, path.points_m, 1),
                    z = extent(landmarks_m, path.points_m, 2);
  const int up = y.span() < z.span() ? 1 : 2;  // z is up in the map of a robot, y down in that of a camera
  const plot::Range& across = x;
  const plot::Range& along = up == 1 ? z : y;
  const double height = std::clamp((kPictureWidth - 90) * along.span() / across.span() + 76, kLowest, kHighest);
  plot::Svg svg(kPictureWidth, height, "Map from above");
  plot::Chart chart = plot::Chart::equal_aspect(svg, {64, 30, kPictureWidth - 90, height - 76}, across, along);
  chart.draw_axes({"x [m]", up == 1 ? "z [m]" : "y [m]"});
  const auto inside = [&](const Eigen::Vector3d& p) {
    const double b = p[3 - up];
    return p.x() >= chart.x().min && p.x() <= chart.x().max && b >= chart.y().min && b <= chart.y().max;
  };
  std::vector<plot::Point> dots;
  for (const Eigen::Vector3d& p : landmarks_m) {
    if (inside(p)) dots.push_back(chart.at(p.x(), p[3 - up]));
  }
  svg.dots(dots, 2.2, palette::kMuted, 0.55);
  std::vector<plot::Point> line;
  for (const Eigen::Vector3d& p : path.points_m) line.push_back(chart.at(p.x(), p[3 - up]));
  svg.polyline(line, {palette::kBlue, 2.2});
  plot::draw_legend(svg, {64, 15}, {{"landmark", palette::kMuted, true}, {"path of the camera", palette::kBlue}});
  return svg.str();
}

}  // namespace rtd::eval
