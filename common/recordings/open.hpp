// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/io/byte_source.hpp"

namespace rtd::recordings {

/// Called now and then with the bytes of the recording's files that have been read.
using Progress = std::function<void(std::uint64_t bytes)>;

/// A recording that can be read as an MCAP file.
struct Opened {
  std::unique_ptr<io::FileSource> source;
  std::string imported;              ///< what it really is: "2 files of rosbag2, zstd"; empty for an MCAP file itself
  std::vector<std::string> damages;  ///< what was lost on the way into MCAP, one line each
};

/// The bytes that `open()` reads at most.
std::uint64_t size_of(const std::string& path);

/// Opens a recording of any form: MCAP, a rosbag2 database, a ROS 1 bag, a folder with one of rosbag2 in one or several
/// files, each of them also packed with zstd as a file or message by message. What is not one MCAP file is copied into
/// one for temporary files (TMPDIR), which goes with the source. Throws mcap::RecordingFileError: missing, no
/// recording, no room for the copy.
Opened open(
    const std::string& path, const Progress& progress = [](std::uint64_t) {});

/// Whether the path looks like a recording of any form. Throws mcap::RecordingFileError when it cannot be read.
bool is_recording(const std::string& path);

}  // namespace rtd::recordings
