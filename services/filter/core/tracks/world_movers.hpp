// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

/// Moving objects for other programs and for people who watch: boxes in the world with velocities. Nothing here decides
/// about a feature.
namespace rtd::filter {

/// What one frame shows of an object, in the frame of its camera.
struct ObjectSighting {
  std::uint32_t source = 0;               ///< the filter's own track: mostly the same in every frame
  std::string class_name;                 ///< empty: found by its motion alone
  double score = 0;                       ///< of the detector
  std::vector<Eigen::Vector3d> points_m;  ///< p_camera, of its surface
  double static_probability = 0;
  bool cut_left = false, cut_right = false;  ///< goes on there behind something nearer, or beyond the border
};

/// Objects that are in view: tracked ones of a high level, others while they move, and movers without a class.
std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays);

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
/// what comes into view is compared with what is expected there. Deterministic, bounded by the objects in view.
class WorldMovers {
 public:
  /// Frames in order of time. Also objects that are hidden now.
  std::vector<WorldMover> place(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera,
                                const std::vector<ObjectSighting>& sightings);
  /// The next ones are others.
  void clear() { tracks_.clear(); }

  /// What a sighting says about an object; world frame.
  struct Look;

 private:
  struct Track {
    std::uint32_t id = 0;
    ObjectSighting last;                                                      ///< without points
    Eigen::Matrix<double, 6, 1> state = Eigen::Matrix<double, 6, 1>::Zero();  ///< of the body: position, velocity
    Matrix6d covariance = Matrix6d::Zero();
    Eigen::Vector3d size_m = Eigen::Vector3d::Zero(), to_middle_m = Eigen::Vector3d::Zero();  ///< of the extent
    Eigen::Vector3d view = Eigen::Vector3d::Zero();  ///< it was last seen along
    double width_m = 0;                              ///< across the view
    std::int64_t first_ns = 0, now_ns = 0, seen_ns = 0;
    int hits = 0;
    double unseen_s() const { return 1e-9 * static_cast<double>(now_ns - seen_ns); }
    Eigen::Vector3d middle() const { return state.head<3>() + to_middle_m; }
  };
  void predict(std::int64_t stamp_ns);
  void place_objects(const Eigen::Isometry3d& T_world_camera, const std::vector<ObjectSighting>& all);
  std::vector<int> assign_looks(const std::vector<ObjectSighting>& sightings, const std::vector<Look>& looks) const;
  static double cost_of(const Track& track, const ObjectSighting& sighting, const Look& look);
  static void update(Track& track, const ObjectSighting& sighting, const Look& look);
  Track start(std::int64_t stamp_ns, const ObjectSighting& sighting, const Look& look);
  static bool forgotten(const Track& track);
  static WorldMover to_mover(const Track& track);

  std::vector<Track> tracks_;
  std::int64_t now_ns_ = 0;
  std::uint32_t next_id_ = 0;
};

}  // namespace rtd::filter
