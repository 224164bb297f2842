// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/camera/tum/tum_export.hpp"
#include "common/mcap/compression.hpp"

namespace rtd::recordings {

/// Writes a source to its end, at most `max_frames` (0: all), to a new MCAP file that mcap: reads back, pixel by pixel,
/// and that the tools of ROS 2 open: /camera/color/image_raw (rgb8), /camera/aligned_depth_to_color/image_raw (16UC1
/// when the source's unit is a millimetre, else 32FC1 metres, as REP 118 says), /camera/color/camera_info, the ground
/// truth as /tf from world to the camera; log time = stamp. The file is FILE.partial until it is complete. Returns the
/// number of frames. Throws SourceError (endless source without max_frames, FILE exists) and io::IoError (disk).
std::uint64_t export_mcap(camera::FrameSource& source, const std::filesystem::path& file, mcap::Compression compression,
                          std::uint64_t max_frames, const camera::OnFrame& on_frame = {});

}  // namespace rtd::recordings
