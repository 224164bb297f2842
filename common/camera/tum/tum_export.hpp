// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// Receives the number of frames written so far.
using OnFrame = std::function<void(std::uint64_t)>;

/// Throws SourceError for an endless source without max_frames.
void check_end(const FrameSource& source, std::uint64_t max_frames);

/// Plays a source to its end, at most `max_frames` (0: all), into a folder in TUM's layout that tum: reads back: rgb/
/// depth/ mask/ as PNG, rgb.txt, depth.txt, associations.txt, groundtruth.txt, calibration.yaml. Returns the number of
/// frames. Throws SourceError: endless source without max_frames, folder that holds a sequence already, disk that
/// refuses.
std::uint64_t export_tum(FrameSource& source, const std::filesystem::path& folder, std::uint64_t max_frames,
                         const OnFrame& on_frame = {});

}  // namespace rtd::camera
