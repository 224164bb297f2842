// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/stamps.hpp"
#include "services/filter/core/boxes/kalman.hpp"
#include "services/filter/core/movers/object_appearance.hpp"
#include "services/filter/core/movers/object_sighting.hpp"

/// Moving objects for other programs and for people who watch: boxes in the world with velocities. Nothing here decides
/// about a feature.
namespace rtd::filter {

/// Covariance of (position, velocity), m and m/s.
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// An object in the world.
struct WorldMover {
  std::uint32_t id = 0;
  std::string class_name;
  double score = 0;  ///< [0, 1] that it is there and of that class; fades while it is unseen
  Eigen::AlignedBox3d extent_world;
  Eigen::Vector3d velocity_world_m_s = Eigen::Vector3d::Zero();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the middle of the extent and of the velocity
  double static_probability = 0;
  double unseen_s = 0;  ///< more than 0: predicted
};

/// Places sightings by slam's poses and follows each body with a Kalman filter of constant velocity
/// (docs/theory/dynamic_points.md section 7). Objects keep their numbers while they are hidden for up to a second:
/// what comes into view is compared, by place and by colour, with what is expected. Deterministic, bounded by the
/// objects in view.
class WorldMovers {
 public:
  /// Frames in order of time. Also objects that are hidden now.
  std::vector<WorldMover> place(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera,
                                const std::vector<ObjectSighting>& sightings);
  /// The next ones are others.
  void clear() { tracks_.clear(); }

 private:
  struct Track {
    std::uint32_t id = 0;
    ObjectSighting last;                                                                      ///< without points
    MotionKalman<3> body;                                                                     ///< m, m/s
    Eigen::Vector3d size_m = Eigen::Vector3d::Zero(), to_middle_m = Eigen::Vector3d::Zero();  ///< of the extent
    Eigen::Vector3d view = Eigen::Vector3d::Zero();  ///< it was last seen along
    double width_m = 0;                              ///< across the view
    double thickness_m = 0;                          ///< along it
    ColorHistogram tints = ColorHistogram::Zero();
    std::int64_t first_ns = 0, now_ns = 0, seen_ns = 0;
    int hits = 0;
    double unseen_s() const { return msg::minus_s(now_ns, seen_ns); }
    Eigen::Vector3d middle() const { return body.position() + to_middle_m; }
  };
  struct Association;
  void predict(std::int64_t stamp_ns);
  Association look_around(const Eigen::Isometry3d& T_world_camera, const std::vector<ObjectSighting>& sightings) const;
  void assign_points(Association& view) const;
  std::optional<ObjectAppearance> look_for(std::size_t track, std::size_t sighting, const Association& view) const;
  void follow(Association& view);
  void recognise(Association& view);
  void start_others(Association& view);
  bool is_new(std::size_t sighting, const Association& view) const;
  static double cost_of(const Track& track, const ObjectSighting& sighting, const ObjectAppearance& look);
  static void update(Track& track, const ObjectSighting& sighting, const ObjectAppearance& look);
  static void put(Track& track, const ObjectAppearance& look);
  Track start(const ObjectSighting& sighting, const ObjectAppearance& look);
  static bool forgotten(const Track& track);
  static WorldMover to_mover(const Track& track);

  std::vector<Track> tracks_;
  std::int64_t now_ns_ = 0;
  std::uint32_t next_id_ = 0;
};

}  // namespace rtd::filter
