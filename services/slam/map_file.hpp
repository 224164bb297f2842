// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/io/atomic_file.hpp"
#include "common/io/byte_source.hpp"
#include "services/slam/core/map/map.hpp"
#include "services/slam/core/store/map_store.hpp"

namespace rtd::slam {

/// Writes the map as io::AtomicFile does: whatever happens on the way, the file is the old map or the new one, whole.
/// Returns its bytes. Throws io::IoError naming file and reason.
std::uint64_t save_map_file(const std::filesystem::path& path, const MapSnapshot& snapshot,
                            io::NamedBy named_by = io::NamedBy::kOperator);

/// Throws io::IoError when it cannot be read, MapFileError when it is no map; both name the file.
MapContents load_map_file(const std::filesystem::path& path, const MapReadOptions& options = {},
                          io::Links links = io::Links::kFollow);

using MapCamera = map_format::StoredCamera;
using MapCameras = std::vector<MapCamera>;

/// The cameras that the keyframes of a map were seen with, each once.
MapCameras cameras_of(const MapContents& contents);

/// How the camera of a frame differs from all cameras of a map, and what to do; empty when it is near one of them:
/// another specimen of the same kind finds its way in the map, another kind or a wrong calibration does not.
std::string difference_to(const MapCameras& cameras, const msg::FeatureFrame& frame);

}  // namespace rtd::slam
