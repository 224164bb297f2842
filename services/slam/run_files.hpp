// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "services/slam/core/slam_system.hpp"

namespace rtd::slam {

/// Writes trajectory.txt, keyframes.txt (TUM format) and map.ply of the first map into `folder`, which is made when
/// missing, and trajectory_map_N.txt for each other map that was never merged: it has a world frame of its own. Call
/// after SlamSystem::finish(). Throws std::runtime_error naming the file that cannot be written.
void write_run_files(const SlamSystem& slam, const std::filesystem::path& folder);

}  // namespace rtd::slam
