// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/tracks/world_movers.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/vision/samples.hpp"
#include "services/filter/core/tracks/assignment.hpp"

namespace rtd::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

// How things are built: of the smaller side across the view, because no back is seen.
constexpr double kThickness = 0.6, kBoxThickness = 1.3;
constexpr double kUpperBody = 0.6;  // share of what is seen of a person, from above: legs swing

// How well they are seen, m; docs/theory/dynamic_points.md section 7.
constexpr double kSigmaAcrossM = 0.04, kSigmaAlongM = 0.05;
constexpr double kUsualJumpM = 0.15;  // of a body; farther ones count less: something came in between
// What no frame averages out: limbs, thickness, surfaces that come into view. On top of the filter's covariance.
constexpr double kBiasAcrossM = 0.03, kBiasAlongM = 0.06, kBiasSpeed_m_s = 0.08;
constexpr double kSpeedShare = 0.5;  // of the filter's deviation: nobody turns at random all the time

// How they move.
constexpr double kAcceleration_m_s2 = 0.7, kFirstSpeed_m_s = 1;
constexpr double kForgetS = 1.0;
constexpr double kSamePlaceM = 0.25;  // two bodies are never so near
constexpr int kFewHits = 10;

/// The interval without the outer twentieths of what lies along a direction.
std::pair<double, double> spread_along(const Points& points, const Vector3d& direction) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3d& point : points) values.push_back(point.dot(direction));
  return vision::spread(values);
}

double median_along(const Points& points, const Vector3d& direction) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3d& point : points) values.push_back(point.dot(direction));
  return vision::median(std::move(values));
}

double width(const std::pair<double, double>& spread) {
  return spread.second - spread.first;
}

Points upper_part(const Points& points_camera, const Points& points_world, double share) {
  const auto [top, bottom] = spread_along(points_camera, Vector3d::UnitY());
  Points upper;
  for (std::size_t i = 0; i < points_camera.size(); ++i) {
    if (points_camera[i].y() <= top + share * (bottom - top)) upper.push_back(points_world[i]);
  }
  return upper;
}

/// Of a direction: more along it than across.
Matrix3d noise(const Vector3d& along, double sigma_across_m, double sigma_along_m) {
  const double across = sigma_across_m * sigma_across_m, extra = sigma_along_m * sigma_along_m - across;
  return across * Matrix3d::Identity() + extra * along * along.transpose();
}

}  // namespace

struct WorldMovers::Look {
  Vector3d view;               ///< from the camera, unit
  Vector3d right;              ///< across the view, unit
  Vector3d surface;            ///< middle of what is seen
  Vector3d body;               ///< middle of what moves as one, behind the surface
  Eigen::AlignedBox3d extent;  ///< as thick as things of its size are
  double width_m = 0;          ///< across
  double thickness = 0;        ///< of its width
  bool covers(const Vector3d& p) const {
    constexpr double kMarginM = 0.1;
    return extent.exteriorDistance(p) < kMarginM;
  }
};

namespace {

/// Without what lies far before or behind the middle of the others: the mask of an object also has cells of what it
/// covers and of what covers it.
Points one_surface(const Points& points_camera) {
  constexpr double kLimitM = 0.4;  // a person with arms stretched out along the view
  const double middle_m = median_along(points_camera, Vector3d::UnitZ());
  Points surface;
  for (const Vector3d& point : points_camera) {
    if (std::abs(point.z() - middle_m) <= kLimitM) surface.push_back(point);
  }
  return surface;
}

WorldMovers::Look look_at(const ObjectSighting& sighting, const Eigen::Isometry3d& T_world_camera) {
  const bool person = !sighting.class_name.empty();
  WorldMovers::Look look;
  const Points surface = one_surface(sighting.points_m);
  Points points;
  points.reserve(surface.size());
  for (const Vector3d& point : surface) points.emplace_back(T_world_camera * point);
  for (int axis = 0; axis < 3; ++axis) look.surface[axis] = median_along(points, Vector3d::Unit(axis));
  for (int axis = 0; axis < 3; ++axis)
    std::tie(look.extent.min()[axis], look.extent.max()[axis]) = spread_along(points, Vector3d::Unit(axis));
  look.view = (look.extent.center() - T_world_camera.translation()).normalized();
  const Vector3d camera_right = T_world_camera.linear().col(0);
  look.right = (camera_right - look.view * look.view.dot(camera_right)).normalized();
  look.width_m = width(spread_along(points, look.right));
  const double height_m = width(spread_along(points, look.view.cross(look.right)));
  look.thickness = person ? kThickness : kBoxThickness;
  const double thickness_m = look.thickness * std::min(look.width_m, height_m);
  const double hidden_m = thickness_m - width(spread_along(points, look.view));
  if (hidden_m > 0) look.extent.extend(look.extent.translated(hidden_m * look.view));
  if (!person) {
    look.body = look.extent.center();
    return look;
  }
  const Points upper = upper_part(surface, points, kUpperBody);
  for (int axis = 0; axis < 3; ++axis) look.body[axis] = median_along(upper, Vector3d::Unit(axis));
  look.body += 0.5 * thickness_m * look.view;
  return look;
}

}  // namespace

std::vector<WorldMover> WorldMovers::place(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera,
                                           const std::vector<ObjectSighting>& sightings) {
  predict(stamp_ns);
  place_objects(T_world_camera, sightings);
  std::erase_if(tracks_, forgotten);
  std::vector<WorldMover> movers;
  for (const Track& track : tracks_) movers.push_back(to_mover(track));
  return movers;
}

void WorldMovers::place_objects(const Eigen::Isometry3d& T_world_camera, const std::vector<ObjectSighting>& all) {
  std::vector<ObjectSighting> sightings;
  std::vector<Look> looks;
  for (const ObjectSighting& sighting : all) {  // those with a class first
    const Look look = look_at(sighting, T_world_camera);
    const bool known = std::ranges::any_of(looks, [&](const Look& other) {
      return (sighting.class_name.empty() && other.covers(look.surface)) ||
             (other.body - look.body).norm() < kSamePlaceM;
    });
    if (known) continue;  // has a class too, or the mask of one behind it lies on it
    looks.push_back(look);
    sightings.push_back(sighting);
  }
  const std::vector<int> look_of = assign_looks(sightings, looks);
  std::vector<char> taken(looks.size(), 0);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (look_of[i] < 0) continue;
    const auto j = static_cast<std::size_t>(look_of[i]);
    taken[j] = 1;
    update(tracks_[i], sightings[j], looks[j]);
  }
  for (std::size_t j = 0; j < looks.size(); ++j) {
    if (taken[j] == 0) tracks_.push_back(start(now_ns_, sightings[j], looks[j]));
  }
}

void WorldMovers::predict(std::int64_t stamp_ns) {
  now_ns_ = stamp_ns;
  for (Track& track : tracks_) {
    const double dt_s = seconds(stamp_ns - track.now_ns), variance = kAcceleration_m_s2 * kAcceleration_m_s2;
    track.now_ns = stamp_ns;
    if (dt_s <= 0) continue;
    Matrix6d transition = Matrix6d::Identity();
    transition.topRightCorner<3, 3>() = dt_s * Matrix3d::Identity();
    track.state = transition * track.state;
    track.covariance = transition * track.covariance * transition.transpose();
    for (int i = 0; i < 3; ++i) {  // white acceleration over dt
      track.covariance(i, i) += variance * dt_s * dt_s * dt_s / 3;
      track.covariance(i, i + 3) += variance * dt_s * dt_s / 2;
      track.covariance(i + 3, i) += variance * dt_s * dt_s / 2;
      track.covariance(i + 3, i + 3) += variance * dt_s;
    }
  }
}

/// By where each is expected; the filter's own tracks tell those apart that are near each other.
std::vector<int> WorldMovers::assign_looks(const std::vector<ObjectSighting>& sightings,
                                           const std::vector<Look>& looks) const {
  constexpr double kMaxGateM = 1.5;
  CostMatrix costs(static_cast<int>(tracks_.size()), static_cast<int>(looks.size()));
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    for (std::size_t j = 0; j < looks.size(); ++j)
      costs.at(static_cast<int>(i), static_cast<int>(j)) = cost_of(tracks_[i], sightings[j], looks[j]);
  }
  return assign(costs, kMaxGateM);
}

double WorldMovers::cost_of(const Track& track, const ObjectSighting& sighting, const Look& look) {
  constexpr double kGateM = 0.4, kYoungM = 0.3, kGateGrowth_m_s = 0.8;
  constexpr double kOtherSourceM = 0.2, kNoClassM = 0.1, kOtherClassM = 0.3;
  const double apart_m = (look.body - track.state.head<3>()).norm();
  const double gate_m = kGateM + (track.hits < kFewHits ? kYoungM : 0) + kGateGrowth_m_s * track.unseen_s();
  if (apart_m > gate_m) return std::numeric_limits<double>::infinity();
  double cost = apart_m;
  if (sighting.source != track.last.source) cost += kOtherSourceM;
  const std::string &seen = sighting.class_name, &known = track.last.class_name;
  if (seen != known) cost += seen.empty() || known.empty() ? kNoClassM : kOtherClassM;
  return cost;
}

void WorldMovers::update(Track& track, const ObjectSighting& sighting, const Look& look) {
  constexpr double kNewShare = 0.1, kSlowShare = 0.02;
  constexpr double kWholeShare = 0.75;
  const bool cut = sighting.cut_left || sighting.cut_right || look.width_m < kWholeShare * track.width_m;
  const double hidden_m = cut ? std::max(0.0, track.width_m - look.width_m) : 0;
  Vector3d body = look.body + 0.5 * look.thickness * hidden_m * look.view;
  if (sighting.cut_left != sighting.cut_right) body += (sighting.cut_right ? 0.5 : -0.5) * hidden_m * look.right;
  const Vector3d jump = body - track.state.head<3>();
  const double far = jump.norm() / kUsualJumpM, loose = 1 + far * far * far * far;
  Matrix3d R = loose * noise(look.view, kSigmaAcrossM, kSigmaAlongM);
  R += hidden_m * hidden_m / 4 * look.right * look.right.transpose();
  const Eigen::Matrix<double, 6, 3> gain =
      track.covariance.leftCols<3>() * (track.covariance.topLeftCorner<3, 3>() + R).inverse();
  track.state += gain * jump;
  Matrix6d kept = Matrix6d::Identity();
  kept.leftCols<3>() -= gain;
  track.covariance = kept * track.covariance * kept.transpose() + gain * R * gain.transpose();

  const double share = std::max(kNewShare, 1.0 / (1 + track.hits));
  if (!cut || track.hits < kFewHits) {
    track.size_m += share * (look.extent.sizes() - track.size_m);
    track.width_m += share * (look.width_m - track.width_m);
    track.to_middle_m +=
        std::max(kSlowShare, 1.0 / (1 + track.hits)) * (look.extent.center() - body - track.to_middle_m);
  }
  track.view = look.view;
  std::string class_name = sighting.class_name.empty() ? track.last.class_name : sighting.class_name;
  track.last = sighting;
  track.last.points_m.clear();
  track.last.class_name = std::move(class_name);
  track.seen_ns = track.now_ns;
  ++track.hits;
}

WorldMovers::Track WorldMovers::start(std::int64_t stamp_ns, const ObjectSighting& sighting, const Look& look) {
  Track track;
  track.id = next_id_++;
  track.last = sighting;
  track.last.points_m.clear();
  track.state.head<3>() = look.body;
  track.covariance.topLeftCorner<3, 3>() = noise(look.view, kSigmaAcrossM, kSigmaAlongM);
  track.covariance.bottomRightCorner<3, 3>() = kFirstSpeed_m_s * kFirstSpeed_m_s * Matrix3d::Identity();
  track.size_m = look.extent.sizes();
  track.to_middle_m = look.extent.center() - look.body;
  track.view = look.view;
  track.width_m = look.width_m;
  track.first_ns = track.now_ns = track.seen_ns = stamp_ns;
  track.hits = 1;
  return track;
}

/// What was seen for a moment only is not expected to be anywhere else.
bool WorldMovers::forgotten(const Track& track) {
  return track.unseen_s() > std::min(kForgetS, seconds(track.seen_ns - track.first_ns));
}

WorldMover WorldMovers::to_mover(const Track& track) {
  const Vector3d middle = track.middle();
  WorldMover mover;
  mover.id = track.id;
  mover.class_name = track.last.class_name;
  mover.score = track.last.score * (1 - track.unseen_s() / kForgetS);
  mover.extent_world = {middle - 0.5 * track.size_m, middle + 0.5 * track.size_m};
  mover.velocity_world_m_s = track.state.tail<3>();
  mover.covariance = track.covariance;
  mover.covariance.rightCols<3>() *= kSpeedShare;
  mover.covariance.bottomRows<3>() *= kSpeedShare;
  mover.covariance.topLeftCorner<3, 3>() += noise(track.view, kBiasAcrossM, kBiasAlongM);
  mover.covariance.bottomRightCorner<3, 3>() += kBiasSpeed_m_s * kBiasSpeed_m_s * Matrix3d::Identity();
  mover.static_probability = track.last.static_probability;
  mover.unseen_s = track.unseen_s();
  return mover;
}

}  // namespace rtd::filter
