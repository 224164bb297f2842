// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/mcap/byte_sink.hpp"
#include "services/slam/core/store/map_reader.hpp"
#include "services/slam/core/store/map_snapshot.hpp"

namespace rtd::slam {

/// Writes FILE.tmp, makes it durable and gives it the name FILE: whatever happens on the way, FILE is the old map or
/// the new one, whole. Returns its bytes. Throws mcap::IoError naming file and reason; FILE.tmp is gone then.
std::uint64_t save_map_file(const std::filesystem::path& path, const MapSnapshot& snapshot);

/// Throws mcap::IoError when it cannot be read, MapFileError when it is no map; both name the file.
MapContents load_map_file(const std::filesystem::path& path, const MapReadOptions& options = {});

}  // namespace rtd::slam
