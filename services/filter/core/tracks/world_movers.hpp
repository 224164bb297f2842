// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"
#include "services/filter/core/tracks/kalman.hpp"

/// Moving objects for people who watch: boxes in the world with velocities. Nothing here decides about a feature.
namespace rtd::filter {

/// What one frame shows of an object, in the frame of its camera.
struct ObjectSighting {
  std::uint32_t id = 0;                   ///< the same in every frame
  std::string class_name;                 ///< empty: found by its motion alone
  std::vector<Eigen::Vector3d> points_m;  ///< p_camera, of its surface
  double static_probability = 0;
};

/// Objects that are in view: tracked ones of a high level, others while they move, and movers without a class.
std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays);

/// An object in the world.
struct WorldMover {
  std::uint32_t id = 0;
  std::string class_name;
  Eigen::AlignedBox3d extent_world;
  Eigen::Vector3d velocity_world_m_s = Eigen::Vector3d::Zero();
  double static_probability = 0;
};

/// Places sightings by slam's poses and follows their centres with one Kalman filter per axis. Forgets what it has not
/// seen for a second. Deterministic, bounded by the objects in view.
class WorldMovers {
 public:
  /// Frames in order of time.
  std::vector<WorldMover> place(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera,
                                const std::vector<ObjectSighting>& sightings);
  void clear() { tracks_.clear(); }

 private:
  struct Track {
    std::array<AxisKalman, 3> axes;  ///< of the centre, m
    std::int64_t stamp_ns = 0;
  };
  Eigen::Vector3d follow(std::uint32_t id, std::int64_t stamp_ns, const Eigen::Vector3d& centre_world);

  std::map<std::uint32_t, Track> tracks_;
};

}  // namespace rtd::filter
