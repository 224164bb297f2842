// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "common/mcap/recording_file.hpp"
#include "services/camera/core/frame_source.hpp"
#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

std::string first_bytes(const fs::path& file) {
  std::string begin(16, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin;
}

/// The only .db3 file in a folder, else the folder itself.
fs::path db3_in(const fs::path& folder) {
  fs::path found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".mcap") return folder;
    if (entry.path().extension() != ".db3") continue;
    if (!found.empty()) throw SourceError(folder.string() + " has several .db3 files; name one");
    found = entry.path();
  }
  return found.empty() ? folder : found;
}

}  // namespace

std::unique_ptr<Recording> open_any(const fs::path& path) try {
  const fs::path file = fs::is_directory(path) ? db3_in(path) : path;
  const std::string begin = first_bytes(file);
  if (begin.starts_with("#ROSBAG")) return open_bag(file);
  if (begin.starts_with("SQLite format 3")) return open_db3(file);
  if (!fs::is_directory(file)) mcap::open_recording(file.string());  // says what the file is instead
  return open_mcap(file);
} catch (const mcap::RecordingFileError& error) {
  throw SourceError(error.what());
} catch (const fs::filesystem_error& error) {
  throw SourceError(error.what());
}

}  // namespace rtd::camera
