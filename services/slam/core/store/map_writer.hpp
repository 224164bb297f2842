// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mcap/byte_sink.hpp"
#include "services/slam/core/store/map_snapshot.hpp"

namespace rtd::slam {

/// Writes a map file (docs/map_file.md) in blocks of about 1 MiB: needs no more memory than that. Throws mcap::IoError,
/// and std::runtime_error when the map could not be read back.
void write_map(const MapSnapshot& snapshot, mcap::ByteSink& sink);

}  // namespace rtd::slam
