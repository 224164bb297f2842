// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"

namespace rtd::filter {

/// The multi-view check as the paper has it (section III-A; Bescos et al., DynaSLAM, section III-C): a keypoint x of a
/// keyframe with its depth is projected to x' in the current frame. Angle between the two viewing rays too large: no
/// statement. Projected depth - measured depth at x' > tau: the pixel x' shows something that has come. Returns the
/// cells of such pixels and their neighbours, so that a feature a few pixels beside x' belongs to it.
CellMask check_keypoint_depths(const vision::RgbdImage& image, const GridShape& shape,
                               const Eigen::Isometry3d& T_world_camera, const std::vector<const View*>& keyframes,
                               const PaperConfig& config);

}  // namespace rtd::filter
