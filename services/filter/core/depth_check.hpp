// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/filter/core/depth_grid.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/view_store.hpp"

namespace rtd::filter {

/// What the reference views say about each cell of the current frame.
struct DepthEvidence {
  std::vector<std::uint8_t>
      violated;  ///< 1: views saw through the place where the surface now is; two of them where there are four or more
  std::vector<std::uint8_t> consistent;  ///< number of views that saw the surface there too
};

/// The multi-view depth check (paper section III-A), docs/theory/dynamic_points.md Eq. (3)-(4), dense.
///
/// Each measured cell of the current frame becomes a point in space. Where a reference view measured clearly farther
/// along its ray to that point, the space was free then: what is there now has come. Where it measured the same depth,
/// the surface was there. Where it measured nearer, the point was hidden: no statement; nor where the two viewing rays
/// differ by more than the angle of the config, the reference measured nothing, or something dynamic.
DepthEvidence check_depth(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                          const Eigen::Isometry3d& T_world_camera, const std::vector<const View*>& references,
                          const geometry::CameraModel& camera, const GeometryConfig& config);

}  // namespace rtd::filter
