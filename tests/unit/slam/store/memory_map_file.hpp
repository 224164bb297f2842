// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"
#include "services/slam/core/store/map_store.hpp"

namespace rtd::slam {

inline io::Bytes bytes_of_map(const MapSnapshot& snapshot) {
  io::MemorySink sink;
  write_map(snapshot, sink);
  return sink.bytes();
}

inline io::Bytes bytes_of_map(const Map& map) {
  return bytes_of_map(take_snapshot(map));
}

inline MapContents read_bytes(io::ByteView bytes, StoredFeatures features = StoredFeatures::kKeep) {
  return read_map(io::MemorySource(bytes), {features, {}});
}

}  // namespace rtd::slam
