// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <vector>

#include "common/rosbag1/record.hpp"

namespace rtd::rosbag1 {

/// A bag that cannot be used, or a piece of it; what() names file, place, cause and fix.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Larger chunks and index records are refused: rosbag writes 0.75 MiB unless told otherwise.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{256} << 20U;

/// Where a record lies in the file.
struct RecordPlace {
  std::vector<std::uint8_t> header;
  std::uint64_t data_begin = 0, data_bytes = 0;
  std::uint64_t end() const { return data_begin + data_bytes; }
};

/// Reads pieces of a file. Each length is held against the size of the file before memory is taken for it.
class BagFile {
 public:
  /// Throws BagError: file that cannot be read, no bag, a bag of another version.
  explicit BagFile(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t first_record() const { return first_record_; }

  /// The record at `position`, its data not yet read. Throws BagError when it does not fit into the file.
  RecordPlace record_at(std::uint64_t position);
  /// Throws BagError when the bytes are not there or more than kMaxChunkBytes.
  std::vector<std::uint8_t> read(std::uint64_t position, std::uint64_t bytes);

 private:
  BagError error_at(std::uint64_t position, const std::string& cause) const;
  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0, first_record_ = 0;
};

}  // namespace rtd::rosbag1
