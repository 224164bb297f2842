// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {

/// Opens a ROS 1 bag. Throws SourceError.
std::unique_ptr<Recording> open_bag(const std::filesystem::path& file);

}  // namespace rtd::camera
