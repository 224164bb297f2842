// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/tracks/world_movers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/vision/samples.hpp"

namespace rtd::filter {
namespace {

constexpr std::size_t kEnoughPoints = 200;  // every n-th cell of a large surface
constexpr double kSeenLatelyS = 0.2;        // movers without a class: longer out of sight is only expected
constexpr double kMoves = 0.5;              // static probability below which an object of a lower level counts
constexpr double kThickness = 0.6, kBoxThickness = 1.3;  // of the smaller side across the view: no back is seen
constexpr double kSigmaM = 0.06;                         // of a centre: limbs swing, surfaces come into view
constexpr double kAcceleration_m_s2 = 1.2;               // of walking people
constexpr double kUsualJumpM = 0.12;  // of a centre; farther ones count less: something came in between
constexpr std::int64_t kForgetNs = 1'000'000'000;

/// Without what lies far before or behind the middle of the others: the mask of an object also has cells of what it
/// covers and of what covers it.
void keep_one_surface(std::vector<Eigen::Vector3d>& points_m) {
  constexpr double kLimitM = 0.4;  // a person with arms stretched out along the view
  std::vector<double> depths_m;
  for (const Eigen::Vector3d& point : points_m) depths_m.push_back(point.z());
  const double middle_m = vision::median(std::move(depths_m));
  std::erase_if(points_m, [&](const Eigen::Vector3d& point) { return std::abs(point.z() - middle_m) > kLimitM; });
}

std::vector<Eigen::Vector3d> points_of(const SceneObject& object, const DepthGrid& grid,
                                       const std::vector<Eigen::Vector3f>& rays) {
  std::vector<Eigen::Vector3d> points_m;
  const std::size_t step = 1 + object.cells.size() / kEnoughPoints;
  for (std::size_t i = 0; i < object.cells.size(); i += step) {
    const auto cell = static_cast<std::size_t>(object.cells[i]);
    if (grid.depth_m[cell] > 0) points_m.push_back((rays[cell] * grid.depth_m[cell]).cast<double>());
  }
  keep_one_surface(points_m);
  return points_m;
}

/// Of the features on an object; of its cells when it has none.
double static_probability_of(std::size_t index, const SceneObject& object, const Verdict& verdict) {
  double sum = 0;
  int count = 0;
  for (const msg::Feature& feature : verdict.features) {
    if (feature.object_id != static_cast<std::int16_t>(index)) continue;
    sum += static_cast<double>(feature.static_probability);
    ++count;
  }
  if (count > 0) return sum / count;
  if (object.cells.empty() || verdict.motion.empty()) return 1;
  const auto dynamic = std::ranges::count_if(
      object.cells, [&](int cell) { return verdict.motion[static_cast<std::size_t>(cell)] == CellMotion::kDynamic; });
  return 1 - static_cast<double>(dynamic) / static_cast<double>(object.cells.size());
}

/// The interval without the outer twentieths of what lies along a direction.
std::pair<double, double> spread_along(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& point : points) values.push_back(point.dot(direction));
  return vision::spread(values);
}

double width(const std::pair<double, double>& spread) {
  return spread.second - spread.first;
}

/// The box around points of which only the front is seen: as thick as things of its size are.
Eigen::AlignedBox3d extent_of(const std::vector<Eigen::Vector3d>& points_world, const Eigen::Vector3d& camera_world,
                              double thickness) {
  Eigen::AlignedBox3d extent;
  for (int axis = 0; axis < 3; ++axis)
    std::tie(extent.min()[axis], extent.max()[axis]) = spread_along(points_world, Eigen::Vector3d::Unit(axis));
  const Eigen::Vector3d view = (extent.center() - camera_world).normalized();
  const Eigen::Vector3d across = view.unitOrthogonal(), other = view.cross(across);
  const double side_m = std::min(width(spread_along(points_world, across)), width(spread_along(points_world, other)));
  const double hidden_m = thickness * side_m - width(spread_along(points_world, view));
  if (hidden_m > 0) extent.extend(extent.translated(hidden_m * view));
  return extent;
}

/// Less moved by limbs than the middle of the extent.
Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
    middle[axis] = vision::median(std::move(values));
  }
  return middle;
}

}  // namespace

std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays) {
  std::vector<ObjectSighting> sightings;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SceneObject& object = objects[i];
    if (object.flat || object.track_id < 0) continue;
    const double probability = static_probability_of(i, object, verdict);
    if (object.level != MotionLevel::kHigh && probability >= kMoves) continue;
    ObjectSighting sighting{2 * static_cast<std::uint32_t>(object.track_id), object.class_name,
                            points_of(object, grid, rays), probability};
    if (!sighting.points_m.empty()) sightings.push_back(std::move(sighting));
  }
  const Eigen::Isometry3d T_camera_world = verdict.T_world_camera.inverse();
  for (const Mover& mover : verdict.movers) {
    if (mover.unseen_s > kSeenLatelyS) continue;
    ObjectSighting& sighting = sightings.emplace_back();
    sighting.id = 2 * static_cast<std::uint32_t>(mover.id) + 1;
    for (int i = 0; i < 8; ++i) {
      const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
      sighting.points_m.emplace_back(T_camera_world * mover.extent_world.corner(corner));
    }
  }
  return sightings;
}

std::vector<WorldMover> WorldMovers::place(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera,
                                           const std::vector<ObjectSighting>& sightings) {
  std::erase_if(tracks_, [&](const auto& track) { return stamp_ns - track.second.stamp_ns > kForgetNs; });
  std::vector<WorldMover> movers;
  for (const ObjectSighting& sighting : sightings) {
    std::vector<Eigen::Vector3d> points_world;
    for (const Eigen::Vector3d& point : sighting.points_m) points_world.emplace_back(T_world_camera * point);
    const Eigen::AlignedBox3d extent =
        extent_of(points_world, T_world_camera.translation(), sighting.class_name.empty() ? kBoxThickness : kThickness);
    const bool known = std::ranges::any_of(movers, [&](const WorldMover& other) {
      return sighting.class_name.empty() && other.extent_world.contains(extent.center());
    });
    if (known) continue;  // a mover that has a class too
    const Eigen::Vector3d centre = sighting.class_name.empty() ? extent.center() : middle_of(points_world);
    movers.push_back(
        {sighting.id, sighting.class_name, extent, follow(sighting.id, stamp_ns, centre), sighting.static_probability});
  }
  return movers;
}

/// The velocity of a centre that is now there.
Eigen::Vector3d WorldMovers::follow(std::uint32_t id, std::int64_t stamp_ns, const Eigen::Vector3d& centre_world) {
  constexpr double kFirstSpeed_m_s = 1;
  const auto [place, is_new] = tracks_.try_emplace(id);
  Track& track = place->second;
  const double dt_s = seconds(stamp_ns - track.stamp_ns);
  track.stamp_ns = stamp_ns;
  Eigen::Vector3d velocity;
  for (Eigen::Index i = 0; i < 3; ++i) {
    AxisKalman& axis = track.axes[static_cast<std::size_t>(i)];
    if (is_new) {
      axis.state = {centre_world[i], 0};
      axis.covariance = Eigen::Vector2d(kSigmaM * kSigmaM, kFirstSpeed_m_s * kFirstSpeed_m_s).asDiagonal();
    } else {
      axis.predict(dt_s, kAcceleration_m_s2);
      const double jump_m = (centre_world[i] - axis.state[0]) / kUsualJumpM;
      axis.update({1, 0}, centre_world[i], kSigmaM * std::sqrt(1 + jump_m * jump_m * jump_m * jump_m));
    }
    velocity[i] = axis.state[1];
  }
  return velocity;
}

}  // namespace rtd::filter
