// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {

/// Opens an MCAP file, or the one in a folder that rosbag2 made. Messages in CDR (ROS 2, ours) and in ROS 1's encoding.
/// Throws SourceError.
std::unique_ptr<Recording> open_mcap(const std::filesystem::path& file);

}  // namespace rtd::camera
