// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <vector>

#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/motion/ego_motion.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/surfaces/foreground.hpp"

namespace rtd::filter {

/// How a surface has moved against the rest of the scene between two views.
struct RelativeMotion {
  /// Squared length of the movement of its middle, in units of the covariances of both motions: chi2 with 3 degrees of
  /// freedom for a surface at rest.
  double distance2 = 0;
  double sigma_m = 0;  ///< standard deviation of the movement in the direction in which it is known least
};

/// Compares the motion of the camera under which each surface stands still with that under which the rest does, each
/// with the covariance that its own sightings give it. By surface; without those that have too few sightings, and
/// without any where the rest has. `rotation`: of the camera, which the rest shows, but not a surface that may turn.
/// docs/theory/dynamic_points.md section 2.
std::map<int, RelativeMotion> relative_motions(const std::map<int, std::vector<PointSighting>>& surfaces,
                                               const std::vector<PointSighting>& rest,
                                               const geometry::CameraModel& camera,
                                               const Eigen::Isometry3d& T_world_camera_start,
                                               const KnownRotation& rotation = {});

/// What one frame says about a surface that may be a carried thing. Votes add up.
enum class SurfaceVote : std::int8_t { kRests = -1, kNone = 0, kMoves = 1 };

/// Per cluster. `in_question`: per feature, 1 = on a surface in question; all others that are not excluded are the rest
/// of the scene. Compared with views 0.1, 0.2 and 0.3 s ago, as far as there are such: the majority counts.
std::vector<SurfaceVote> vote_on_surfaces(const EgoMotionInput& input, const std::vector<char>& in_question,
                                          const EgoMotionConfig& config);

/// The surfaces of a frame of which a start must not make use yet.
struct UndecidedSurfaces {
  CellMask open;    ///< per cell, not 0 = on a surface of which it is too early to say whether it moves
  CellMask moving;  ///< per cell, 1 = on one that was found to move by itself
};

/// After a start, any of the surfaces that stand out may be a carried thing, and a camera's motion that follows it
/// explains the first frames as well. Such surfaces stay in question until the votes of the frames say the same twice
/// more often than the other. docs/theory/dynamic_points.md section 2.
class SurfaceDecisions {
 public:
  /// Brings what was found out up to the last frame to this one. `T_current_last` may be a prediction.
  void recall(const DepthGrid& grid, const geometry::CameraModel& camera, const Eigen::Isometry3d& T_current_last,
              double elapsed_s);
  /// The surfaces in question in this frame. `excluded`: cells whose features are not used anyway.
  UndecidedSurfaces find(const Surroundings& surroundings, const CellMask& excluded, double min_step_m);
  /// Takes in what this frame says about them: `votes` per cluster.
  void update(UndecidedSurfaces& undecided, const DepthClusters& clusters, const std::vector<SurfaceVote>& votes);
  /// Remembers this frame.
  void store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays);
  void clear();

 private:
  DynamicMemory memory_;
  CellMask notes_;  ///< per cell of this frame, see the source file
};

}  // namespace rtd::filter
