// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/motion/surface_motion.hpp"
#include "services/filter/core/surfaces/standing_out.hpp"

namespace rtd::filter {

/// The surfaces of a frame of which a start must not make use yet.
struct Questions {
  CellMask open;    ///< per cell, not 0 = on a surface of which it is too early to say whether it moves
  CellMask moving;  ///< per cell, 1 = on one that was found to move by itself
};

/// After a start, any of the surfaces that stand out may be a carried thing, and a camera's motion that follows it
/// explains the first frames as well. Such surfaces stay in question until the votes of the frames say the same twice
/// more often than the other. docs/theory/dynamic_points.md section 2.
class SurfaceQuestions {
 public:
  /// Brings what was found out up to the last frame to this one. `T_current_last` may be a prediction.
  void recall(const DepthGrid& grid, const geometry::CameraModel& camera, const Eigen::Isometry3d& T_current_last,
              double elapsed_s);
  /// The surfaces in question in this frame. `excluded`: cells whose features are not used anyway.
  Questions ask(const Surroundings& surroundings, const CellMask& excluded, double min_step_m);
  /// Takes in what this frame says about them: `votes` per cluster.
  void answer(Questions& questions, const DepthClusters& clusters, const std::vector<SurfaceVote>& votes);
  /// Remembers this frame.
  void store(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays);
  void clear();

 private:
  DynamicMemory memory_;
  CellMask notes_;  ///< per cell of this frame, see the source file
};

}  // namespace rtd::filter
