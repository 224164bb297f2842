// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rtd::recordings {

/// The files that make up a recording.
struct Parts {
  std::vector<std::filesystem::path> files;  ///< in the order of recording
  std::vector<std::string> missing;          ///< named by metadata.yaml, but not there
  bool packed_messages = false;              ///< rosbag2's compression mode MESSAGE: each is a zstd frame
};

/// A file stands for itself. Of a folder: the files that its metadata.yaml (rosbag2) names, else all recordings in it,
/// whose names must be the same but for the numbers at their ends. Throws mcap::RecordingFileError: no such path, no
/// recording in the folder, metadata.yaml damaged or without files that are there.
Parts parts_of(const std::filesystem::path& path);

/// Whether a folder holds a recording.
bool holds_recording(const std::filesystem::path& folder);

}  // namespace rtd::recordings
