// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// What the reference views show about each cell of the current frame.
struct DepthEvidence {
  std::vector<std::uint8_t>
      violated;  ///< 1 = views saw through the place where the surface now is: two of them where there are four or more
  std::vector<std::uint8_t> consistent;  ///< number of views that saw the surface there too
  std::vector<std::uint8_t> lasting;     ///< 1 = views of at least 0.4 s ago saw it there, and none saw through it
  std::vector<std::uint8_t> settled;     ///< 1 = violated, but only by views from before 0.7 s ago; one of 0.4 to 0.7 s
                                         ///< ago saw it there
  static DepthEvidence none(std::size_t cells) {
    const std::vector<std::uint8_t> zero(cells, 0);
    return {zero, zero, zero, zero};
  }
};

/// Pose of the camera at a time.
struct CameraPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// The multi-view depth check (paper section III-A), docs/theory/dynamic_points.md Eq. (3)-(4), dense.
///
/// Each measured cell of the current frame becomes a point in space. Where a reference view measured clearly farther
/// along its ray to that point, the space was free then: what is there now has arrived. Where it measured the same
/// depth, the surface was there. Where it measured nearer, the point was hidden: no statement; nor where the two
/// viewing rays differ by more than the angle of the config, the reference measured nothing, or (for `consistent`)
/// something dynamic.
DepthEvidence check_depth(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays, const CameraPose& pose,
                          const std::vector<const View*>& references, const geometry::CameraModel& camera,
                          const GeometryConfig& config);

}  // namespace rtd::filter
