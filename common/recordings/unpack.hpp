// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/io/byte_sink.hpp"
#include "common/io/byte_source.hpp"

namespace rtd::recordings {

/// Called now and then with the bytes of the recording's files that have been read.
using Progress = std::function<void(std::uint64_t bytes)>;

/// A file of its own in the folder for temporary files (TMPDIR), removed with this object: what has it open then keeps
/// its content.
class TemporaryFile {
 public:
  TemporaryFile();
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Whether it begins as a zstd frame does.
bool is_packed(const io::ByteSource& source);

/// Appends what the zstd frames in `source` hold. At most nine tenths of the space that is free where `sink` is are
/// filled. Throws io::IoError (disk, no room). Returns what is damaged; empty for a whole file.
std::string unpack(const io::ByteSource& source, io::FileSink& sink, const Progress& progress);

}  // namespace rtd::recordings
