// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace rtd::test {

/// Fields of a record's header.
using Fields = std::vector<std::pair<std::string, std::string>>;

std::string little_endian(std::uint64_t value, int bytes);
/// A record of the bag format. Tests damage what they put together.
std::string bag_record(const Fields& header, const std::string& data);

/// Puts a ROS 1 bag together in memory.
class BagWriter {
 public:
  explicit BagWriter(std::string compression = "none") : compression_(std::move(compression)) {}

  std::uint32_t connection(const std::string& topic, const std::string& type, const std::string& definition = "");
  void message(std::uint32_t connection, std::int64_t time_ns, std::span<const std::uint8_t> bytes);
  /// Closes the chunk; the next message begins another.
  void end_chunk();
  /// As rosbag leaves it: connections and chunk infos at the end.
  std::string closed();
  /// As a writer leaves it that was killed: no index of the last chunk, nothing at the end.
  std::string killed();

  static std::string bag_header(std::uint64_t index_pos, const Fields& more = {});
  static constexpr const char* kVersion = "#ROSBAG V2.0\n";

 private:
  std::string chunk_record() const;
  std::string compression_, body_, chunk_;
  std::map<std::uint32_t, std::string> index_;        ///< of the open chunk, by connection
  std::map<std::uint32_t, std::string> connections_;  ///< their records
  std::map<std::uint32_t, bool> described_;           ///< in some chunk
};

/// Writes bytes to a file of its own that goes with the object.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& bytes) : path_(folder_.write(name, bytes)) {}
  const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
};

}  // namespace rtd::test
