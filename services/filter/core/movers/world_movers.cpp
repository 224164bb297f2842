// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/movers/world_movers.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "services/filter/core/boxes/assignment.hpp"

namespace rtd::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using SeenPoints = std::vector<SeenPoint>;

// How well they are seen, m; docs/theory/dynamic_points.md section 7.
constexpr double kSigmaAcrossM = 0.04, kSigmaAlongM = 0.05;
constexpr double kUsualJumpM = 0.15;  // of a body; farther ones count less: something came in between
// What no frame averages out: limbs, thickness, surfaces that come into view. On top of the filter's covariance.
constexpr double kBiasAcrossM = 0.03, kBiasAlongM = 0.06, kBiasSpeed_m_s = 0.08;
constexpr double kSpeedShare = 0.5;  // of the filter's deviation: people do not turn at random all the time

// How they move.
constexpr double kAcceleration_m_s2 = 0.7, kFirstSpeed_m_s = 1;
constexpr double kForgetS = 1.0;
constexpr double kSamePlaceM = 0.35;  // two bodies are never so near
constexpr int kFewHits = 10;
constexpr double kMax = 0.5;  // of the points of a surface

/// Of a direction: more along it than across.
Matrix3d noise(const Vector3d& along, double sigma_across_m, double sigma_along_m) {
  const double across = sigma_across_m * sigma_across_m, extra = sigma_along_m * sigma_along_m - across;
  return across * Matrix3d::Identity() + extra * along * along.transpose();
}

/// Of the body, for one of a known thickness: a person who turns looks narrower or wider but is as thick as before.
Vector3d body_of(const ObjectAppearance& look, double thickness_m) {
  return look.body + 0.5 * (thickness_m - look.thickness_m) * look.view;
}

ObjectSighting without_points(const ObjectSighting& sighting) {
  return {.source = sighting.source,
          .class_name = sighting.class_name,
          .score = sighting.score,
          .static_probability = sighting.static_probability};
}

/// Where the points of a body are expected. For a point, how far it lies from there: its distance from the surface in
/// metres, more for a tint that the body hardly has, up to 0.4 m.
struct Expectation {
  Vector3d body;
  Vector3d down = Vector3d::Zero();  ///< of an upright person, else 0: heights do not count
  double reach_m = 0;
  std::array<double, kTints> far_m{};  ///< by tint
  double away_m(const Vector3d& p_world, std::uint8_t tint) const {
    const Vector3d away = p_world - body;
    return (away - down * down.dot(away)).norm() - reach_m + far_m[tint];
  }
};

/// Index of the one that a point belongs to; -1 = none.
int owner_of(const Vector3d& p_world, std::uint8_t tint, const std::vector<Expectation>& expected) {
  constexpr double kFarthestM = 0.4;
  double nearest_m = kFarthestM;
  int owner = -1;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double away_m = expected[i].away_m(p_world, tint);
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    owner = static_cast<int>(i);
  }
  return owner;
}

}  // namespace

/// What a frame shows of the tracks.
struct WorldMovers::Association {
  const std::vector<ObjectSighting>& sightings;
  Eigen::Isometry3d T_world_camera;
  std::vector<ObjectAppearance> looks;          ///< at the surface of each sighting
  std::vector<std::vector<double>> share;       ///< [sighting][track]: of this surface's points
  std::vector<std::vector<SeenPoints>> moving;  ///< [sighting][track]: of what moves in the box
  std::vector<char> taken;                      ///< per sighting: a track has it
};

std::vector<WorldMover> WorldMovers::place(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera,
                                           const std::vector<ObjectSighting>& sightings) {
  predict(stamp_ns);
  Association view = look_around(T_world_camera, sightings);
  follow(view);
  recognise(view);
  start_others(view);
  std::erase_if(tracks_, forgotten);
  std::vector<WorldMover> movers;
  for (const Track& track : tracks_) movers.push_back(to_mover(track));
  return movers;
}

void WorldMovers::predict(std::int64_t stamp_ns) {
  now_ns_ = stamp_ns;
  for (Track& track : tracks_) {
    const double dt_s = msg::minus_s(stamp_ns, track.now_ns);
    track.now_ns = stamp_ns;
    if (dt_s > 0) track.body.predict(dt_s, kAcceleration_m_s2);
  }
}

WorldMovers::Association WorldMovers::look_around(const Eigen::Isometry3d& T_world_camera,
                                                  const std::vector<ObjectSighting>& sightings) const {
  Association view{sightings, T_world_camera, {}, {}, {}, std::vector<char>(sightings.size(), 0)};
  for (const ObjectSighting& sighting : sightings) view.looks.push_back(measure(sighting, T_world_camera));
  assign_points(view);
  return view;
}

/// Each point to the body that it is expected of.
void WorldMovers::assign_points(Association& view) const {
  constexpr double kFarPerDecadeM = 0.2, kHardly = 0.01;  // metres for a tenth as much of a tint
  constexpr double kNotSeenM = 0.05, kLatelyS = 0.1;      // in doubt, a point is of a person in view
  std::vector<Expectation> expected;
  for (const Track& track : tracks_) {
    const bool upright = !track.last.class_name.empty();
    Expectation& of = expected.emplace_back(Expectation{.body = track.body.position()});
    if (upright) of.down = view.T_world_camera.linear().col(1);
    of.reach_m = 0.5 * (upright ? track.width_m : track.size_m.mean());
    if (track.unseen_s() > kLatelyS) of.reach_m -= kNotSeenM;
    for (int tint = 0; tint < kTints; ++tint)
      of.far_m[static_cast<std::size_t>(tint)] = -kFarPerDecadeM * std::log10(track.tints[tint] + kHardly);
  }
  const auto owner = [&](const SeenPoint& point) {
    return owner_of(view.T_world_camera * point.p_camera_m, point.tint, expected);
  };
  for (const ObjectSighting& sighting : view.sightings) {
    std::vector<double>& share = view.share.emplace_back(tracks_.size(), 0.0);
    for (const SeenPoint& point : sighting.points) {
      if (const int of = owner(point); of >= 0)
        share[static_cast<std::size_t>(of)] += 1.0 / static_cast<double>(sighting.points.size());
    }
    std::vector<SeenPoints>& moving = view.moving.emplace_back(tracks_.size());
    for (const SeenPoint& point : sighting.moving) {
      if (const int of = owner(point); of >= 0) moving[static_cast<std::size_t>(of)].push_back(point);
    }
  }
}

/// A track in a sighting: its surface, if that is where the track is expected and not of another one; else what the
/// track has of the rest. Of two boxes that overlap in the image, both show the nearer body's surface.
std::optional<ObjectAppearance> WorldMovers::look_for(std::size_t track, std::size_t sighting,
                                                      const Association& view) const {
  constexpr double kLatelyS = 0.3;
  constexpr int kSomeHits = 3;
  constexpr std::size_t kFewPoints = 25;
  const ObjectSighting& seen = view.sightings[sighting];
  bool of_another = false;
  for (std::size_t k = 0; k < view.share[sighting].size(); ++k) {
    const bool in_view = tracks_[k].unseen_s() < kLatelyS && tracks_[k].hits >= kSomeHits;
    of_another = of_another || (k != track && in_view && view.share[sighting][k] >= kMax);
  }
  if (!of_another && std::isfinite(cost_of(tracks_[track], seen, view.looks[sighting]))) return view.looks[sighting];
  const SeenPoints& rest = view.moving[sighting][track];
  if (rest.size() < kFewPoints) return std::nullopt;
  return measure(rest, !seen.class_name.empty(), view.T_world_camera);
}

/// Tracks where they are expected.
void WorldMovers::follow(Association& view) {
  constexpr double kMaxGateM = 1.5;
  const std::size_t tracks = tracks_.size(), sightings = view.sightings.size();
  CostMatrix costs(static_cast<int>(tracks), static_cast<int>(sightings));
  std::vector<std::vector<std::optional<ObjectAppearance>>> looks(tracks);
  for (std::size_t i = 0; i < tracks; ++i) {
    for (std::size_t j = 0; j < sightings; ++j) {
      const auto& look = looks[i].emplace_back(look_for(i, j, view));
      if (look) costs.at(static_cast<int>(i), static_cast<int>(j)) = cost_of(tracks_[i], view.sightings[j], *look);
    }
  }
  const std::vector<int> sighting_of = assign(costs, kMaxGateM);
  for (std::size_t i = 0; i < tracks; ++i) {
    if (sighting_of[i] < 0) continue;
    const auto j = static_cast<std::size_t>(sighting_of[i]);
    view.taken[j] = 1;
    update(tracks_[i], view.sightings[j], *looks[i][j]);
  }
}

/// By place, colour and class; the filter's own tracks separate those that are near each other.
double WorldMovers::cost_of(const Track& track, const ObjectSighting& sighting, const ObjectAppearance& look) {
  constexpr double kGateM = 0.4, kYoungM = 0.3, kGateGrowth_m_s = 0.8;
  constexpr double kOtherSourceM = 0.2, kNoClassM = 0.6, kOtherClassM = 0.3, kUnlikeM = 1;
  const double apart_m = (look.body - track.body.position()).norm();
  const double gate_m = kGateM + (track.hits < kFewHits ? kYoungM : 0) + kGateGrowth_m_s * track.unseen_s();
  if (apart_m > gate_m) return std::numeric_limits<double>::infinity();
  double cost = apart_m + kUnlikeM * histogram_distance(look.tints, track.tints);
  if (sighting.source && sighting.source != track.last.source) cost += kOtherSourceM;
  const std::string &seen = sighting.class_name, &known = track.last.class_name;
  if (seen != known) cost += seen.empty() || known.empty() ? kNoClassM : kOtherClassM;
  return cost;
}

/// Tracks elsewhere: what would be new but has the colours of one that is missing and could have come here.
void WorldMovers::recognise(Association& view) {
  constexpr double kUnlike = 0.2, kNearM = 1, kSpeed_m_s = 1.5;
  constexpr double kCostPerM = 0.2, kNoLimit = 10;
  CostMatrix costs(static_cast<int>(tracks_.size()), static_cast<int>(view.sightings.size()));
  for (std::size_t j = 0; j < view.sightings.size(); ++j) {
    if (!is_new(j, view)) continue;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const Track& track = tracks_[i];
      if (track.unseen_s() <= 0 || track.hits < kFewHits) continue;
      const double different = histogram_distance(track.tints, view.looks[j].tints);
      const double apart_m = (track.body.position() - view.looks[j].body).norm();
      if (different < kUnlike && apart_m < kNearM + kSpeed_m_s * track.unseen_s())
        costs.at(static_cast<int>(i), static_cast<int>(j)) = different + kCostPerM * apart_m;
    }
  }
  const std::vector<int> sighting_of = assign(costs, kNoLimit);
  for (std::size_t i = 0; i < sighting_of.size(); ++i) {
    if (sighting_of[i] < 0) continue;
    const auto j = static_cast<std::size_t>(sighting_of[i]);
    view.taken[j] = 1;
    put(tracks_[i], view.looks[j]);
    update(tracks_[i], view.sightings[j], view.looks[j]);
  }
}

void WorldMovers::start_others(Association& view) {
  for (std::size_t j = 0; j < view.sightings.size(); ++j) {
    if (is_new(j, view)) tracks_.push_back(start(view.sightings[j], view.looks[j]));
  }
}

/// A surface that no track in view explains: it neither consists of points of theirs nor lies where one is, and a mover
/// without a class is not part of something with one.
bool WorldMovers::is_new(std::size_t sighting, const Association& view) const {
  if (view.taken[sighting] != 0 || !view.sightings[sighting].source) return false;
  double known = 0;
  for (std::size_t i = 0; i < view.share[sighting].size(); ++i) {
    if (tracks_[i].unseen_s() <= 0) known += view.share[sighting][i];
  }
  const ObjectAppearance& look = view.looks[sighting];
  const bool near = std::ranges::any_of(tracks_, [&](const Track& track) {
    return track.unseen_s() <= 0 && (track.body.position() - look.body).norm() < kSamePlaceM;
  });
  bool part = false;
  for (std::size_t k = 0; k < view.sightings.size() && view.sightings[sighting].class_name.empty(); ++k)
    part = part || (!view.sightings[k].class_name.empty() && view.looks[k].covers(look.surface));
  return known <= kMax && !near && !part;
}

void WorldMovers::update(Track& track, const ObjectSighting& sighting, const ObjectAppearance& look) {
  constexpr double kNewShare = 0.1, kSlowShare = 0.02, kTintShare = 0.1;
  constexpr double kWholeShare = 0.75;
  const bool cut = look.cut_left || look.cut_right || look.width_m < kWholeShare * track.width_m;
  const double hidden_m = cut ? std::max(0.0, track.width_m - look.width_m) : 0;
  Vector3d body = body_of(look, track.thickness_m);
  if (look.cut_left != look.cut_right) body += (look.cut_right ? 0.5 : -0.5) * hidden_m * look.right;
  const Vector3d jump = body - track.body.position();
  const double far = jump.norm() / kUsualJumpM, loose = 1 + far * far * far * far;
  Matrix3d R = loose * noise(look.view, kSigmaAcrossM, kSigmaAlongM);
  R += hidden_m * hidden_m / 4 * look.right * look.right.transpose();
  track.body.update<3>(MotionKalman<3>::Observation<3>::Identity(), body, R);

  const double share = std::max(kNewShare, 1.0 / (1 + track.hits));
  if (!cut || track.hits < kFewHits) {
    track.size_m += share * (look.extent.sizes() - track.size_m);
    track.width_m += share * (look.width_m - track.width_m);
    track.tints += kTintShare * (look.tints - track.tints);
    const double slow_share = std::max(kSlowShare, 1.0 / (1 + track.hits));
    track.thickness_m += slow_share * (look.thickness_m - track.thickness_m);
    track.to_middle_m += slow_share * (look.extent.center() - body - track.to_middle_m);
  }
  track.view = look.view;
  const std::string class_name = sighting.class_name.empty() ? track.last.class_name : sighting.class_name;
  const std::optional<std::uint32_t> source = sighting.source ? sighting.source : track.last.source;
  track.last = without_points(sighting);
  track.last.class_name = class_name;
  track.last.source = source;
  track.seen_ns = track.now_ns;
  ++track.hits;
}

/// Where it is seen, at any speed.
void WorldMovers::put(Track& track, const ObjectAppearance& look) {
  track.body.state.head<3>() = look.body;
  track.body.covariance.setZero();
  track.body.covariance.topLeftCorner<3, 3>() = noise(look.view, kSigmaAcrossM, kSigmaAlongM);
  track.body.covariance.bottomRightCorner<3, 3>() = kFirstSpeed_m_s * kFirstSpeed_m_s * Matrix3d::Identity();
}

WorldMovers::Track WorldMovers::start(const ObjectSighting& sighting, const ObjectAppearance& look) {
  Track track;
  track.id = next_id_++;
  track.last = without_points(sighting);
  put(track, look);
  track.size_m = look.extent.sizes();
  track.to_middle_m = look.extent.center() - look.body;
  track.view = look.view;
  track.width_m = look.width_m;
  track.thickness_m = look.thickness_m;
  track.tints = look.tints;
  track.first_ns = track.now_ns = track.seen_ns = now_ns_;
  track.hits = 1;
  return track;
}

/// What was seen for a moment only is not expected to be anywhere else.
bool WorldMovers::forgotten(const Track& track) {
  return track.unseen_s() > std::min(kForgetS, msg::minus_s(track.seen_ns, track.first_ns));
}

WorldMover WorldMovers::to_mover(const Track& track) {
  const Vector3d middle = track.middle();
  WorldMover mover;
  mover.id = track.id;
  mover.class_name = track.last.class_name;
  mover.score = track.last.score * (1 - track.unseen_s() / kForgetS);
  mover.extent_world = {middle - 0.5 * track.size_m, middle + 0.5 * track.size_m};
  mover.velocity_world_m_s = track.body.velocity();
  mover.covariance = track.body.covariance;
  mover.covariance.rightCols<3>() *= kSpeedShare;
  mover.covariance.bottomRows<3>() *= kSpeedShare;
  mover.covariance.topLeftCorner<3, 3>() += noise(track.view, kBiasAcrossM, kBiasAlongM);
  mover.covariance.bottomRightCorner<3, 3>() += kBiasSpeed_m_s * kBiasSpeed_m_s * Matrix3d::Identity();
  mover.static_probability = track.last.static_probability;
  mover.unseen_s = track.unseen_s();
  return mover;
}

}  // namespace rtd::filter
