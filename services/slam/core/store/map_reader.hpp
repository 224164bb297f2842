// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "common/io/byte_source.hpp"
#include "services/slam/core/map/map.hpp"
#include "services/slam/core/store/map_format.hpp"

namespace rtd::slam {

/// What is kept of the features: all are read and checked.
enum class StoredFeatures { kKeep, kSkip };

struct MapReadOptions {
  /// kSkip: frames have stamp and camera only.
  StoredFeatures features = StoredFeatures::kKeep;
  std::function<void(std::uint64_t)> on_progress;  ///< called with the bytes read so far; may be empty
};

/// Reads a map file (docs/map_file.md). What it returns is sound: every number is possible, every cross reference
/// holds. Throws MapFileError for everything else, whatever the bytes are; holds a bounded multiple of their size.
MapContents read_map(const io::ByteSource& source, const MapReadOptions& options = {});

}  // namespace rtd::slam
