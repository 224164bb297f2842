// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/camera/depth_alignment.hpp"
#include "common/camera/recording/recording.hpp"

namespace rtd::camera {

/// T_color_depth of a recording: identity for images in one frame, otherwise by the transforms that the RealSense SDK
/// records with each stream, otherwise by tf (tf_static first). Reads transforms until it is found, whatever else was
/// played before; empty when it is not. Throws SourceError.
std::optional<Eigen::Isometry3d> recorded_extrinsics(Recording& recording, const ImageOrigin& color,
                                                     const ImageOrigin& depth);

}  // namespace rtd::camera
