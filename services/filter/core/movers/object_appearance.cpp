// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/movers/object_appearance.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

using Eigen::Vector3d;
using WorldPoints = std::vector<Vector3d>;

// How things are built: of the smaller side across the view, because no back is seen.
constexpr double kThickness = 0.6, kBoxThickness = 1.3;
constexpr double kUpperBody = 0.6;  // share of what is seen of a person, from above: legs swing

/// The interval without the outer twentieths of what lies along a direction.
std::pair<double, double> spread_along(const WorldPoints& points, const Vector3d& direction) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3d& point : points) values.push_back(point.dot(direction));
  return vision::spread(values);
}

double median_along(const WorldPoints& points, const Vector3d& direction) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3d& point : points) values.push_back(point.dot(direction));
  return vision::median(std::move(values));
}

double width(const std::pair<double, double>& spread) {
  return spread.second - spread.first;
}

Vector3d median(const WorldPoints& points) {
  return {median_along(points, Vector3d::UnitX()), median_along(points, Vector3d::UnitY()),
          median_along(points, Vector3d::UnitZ())};
}

/// Without what lies far before or behind the middle of the others: the mask of an object also has cells of what it
/// covers and of what covers it.
std::vector<SeenPoint> one_surface(const std::vector<SeenPoint>& points) {
  constexpr double kLimitM = 0.4;  // a person with arms stretched out along the view
  std::vector<double> depths_m;
  for (const SeenPoint& point : points) depths_m.push_back(point.p_camera_m.z());
  const double middle_m = vision::median(std::move(depths_m));
  std::vector<SeenPoint> surface;
  for (const SeenPoint& point : points) {
    if (std::abs(point.p_camera_m.z() - middle_m) <= kLimitM) surface.push_back(point);
  }
  return surface;
}

std::vector<SeenPoint> upper_part(const std::vector<SeenPoint>& surface) {
  std::vector<double> heights_m;  // downwards
  for (const SeenPoint& point : surface) heights_m.push_back(point.p_camera_m.y());
  const auto [top, bottom] = vision::spread(heights_m);
  std::vector<SeenPoint> upper;
  for (const SeenPoint& point : surface) {
    if (point.p_camera_m.y() <= top + kUpperBody * (bottom - top)) upper.push_back(point);
  }
  return upper;
}

WorldPoints to_world(const std::vector<SeenPoint>& surface, const Eigen::Isometry3d& T_world_camera) {
  WorldPoints points;
  points.reserve(surface.size());
  for (const SeenPoint& point : surface) points.emplace_back(T_world_camera * point.p_camera_m);
  return points;
}

ColorHistogram shares_of_tints(const std::vector<SeenPoint>& points) {
  ColorHistogram shares = ColorHistogram::Zero();
  for (const SeenPoint& point : points) shares[point.tint] += 1;
  return shares / static_cast<double>(points.size());
}

}  // namespace

ObjectAppearance measure(const std::vector<SeenPoint>& points, bool upright, const Eigen::Isometry3d& T_world_camera) {
  ObjectAppearance look;
  const std::vector<SeenPoint> surface = one_surface(points), upper = upper_part(surface);
  const WorldPoints seen = to_world(surface, T_world_camera);
  look.tints = shares_of_tints(upper);
  look.surface = median(seen);
  for (int axis = 0; axis < 3; ++axis)
    std::tie(look.extent.min()[axis], look.extent.max()[axis]) = spread_along(seen, Vector3d::Unit(axis));
  look.view = (look.extent.center() - T_world_camera.translation()).normalized();
  const Vector3d camera_right = T_world_camera.linear().col(0);
  look.right = (camera_right - look.view * look.view.dot(camera_right)).normalized();
  look.width_m = width(spread_along(seen, look.right));
  const double height_m = width(spread_along(seen, look.view.cross(look.right)));
  look.thickness_m = (upright ? kThickness : kBoxThickness) * std::min(look.width_m, height_m);
  const double hidden_m = look.thickness_m - width(spread_along(seen, look.view));
  if (hidden_m > 0) look.extent.extend(look.extent.translated(hidden_m * look.view));
  look.body = upright ? Vector3d(median(to_world(upper, T_world_camera)) + 0.5 * look.thickness_m * look.view)
                      : look.extent.center();
  return look;
}

ObjectAppearance measure(const ObjectSighting& sighting, const Eigen::Isometry3d& T_world_camera) {
  ObjectAppearance look = measure(sighting.points, !sighting.class_name.empty(), T_world_camera);
  look.cut_left = sighting.cut_left;
  look.cut_right = sighting.cut_right;
  return look;
}

}  // namespace rtd::filter
