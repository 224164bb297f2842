// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/map_file.hpp"

#include "services/slam/core/store/map_writer.hpp"

namespace rtd::slam {

std::uint64_t save_map_file(const std::filesystem::path& path, const MapSnapshot& snapshot) {
  std::filesystem::path unfinished = path;
  unfinished += ".tmp";
  mcap::FileSink sink(unfinished, mcap::IfExists::kReplace);
  try {
    write_map(snapshot, sink);
    sink.replace(path);
  } catch (...) {
    std::error_code ignored;  // the first failure is the one to tell
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
  return sink.position();
}

MapContents load_map_file(const std::filesystem::path& path, const MapReadOptions& options) {
  const mcap::FileSource source(path);
  try {
    return read_map(source, options);
  } catch (const MapFileError& error) {
    throw MapFileError(error.defect(), path.string() + ": " + error.what());
  }
}

}  // namespace rtd::slam
