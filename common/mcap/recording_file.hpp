// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "common/io/byte_source.hpp"

namespace rtd::mcap {

/// A file cannot be used as a recording; what() names it, the cause and the fix.
class RecordingFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file that a person means: the path itself or, if it is a folder, the only .mcap file in it. Throws io::IoError
/// (byte_sink.hpp): the folder holds no recording, or several parts of a split one.
std::filesystem::path recording_path(const std::filesystem::path& path);

/// Throws RecordingFileError, which says what the file is instead, unless looks_like_recording(). `path` is for the
/// text.
void require_recording(const io::ByteSource& source, const std::string& path);

/// Opens an MCAP file, or the only one of a folder. Throws RecordingFileError: missing, unreadable, empty, another
/// format. A file whose first bytes are damaged passes when a header follows.
io::FileSource open_recording(const std::string& path);

/// What a file of another well-known format is and how to make a recording of it: "a ROS 1 bag: ..."; empty for all
/// other files. Throws RecordingFileError.
std::string other_format(const std::string& path);

/// True when the file begins as an MCAP file does, or as one whose magic is damaged.
bool looks_like_recording(const io::ByteSource& source);

}  // namespace rtd::mcap
