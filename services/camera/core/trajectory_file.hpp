// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Reads a TUM trajectory ("stamp tx ty tz qx qy qz qw", seconds and metres). Throws SourceError naming file and line
/// for what is no finite number or no rotation: a wrong reference would falsify every figure.
std::vector<StampedPose> read_tum_trajectory(const std::filesystem::path& file);

/// The poses as a TUM trajectory, stamps with 6 and values with 9 decimals.
std::string to_tum_trajectory(const std::vector<StampedPose>& poses);

}  // namespace rtd::camera
