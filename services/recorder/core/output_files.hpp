// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rtd::recorder {

/// The files of a recording. "run.mcap" is that file, or run_0.mcap, run_1.mcap, ... when it is split. Anything else is
/// a folder in the layout of rosbag2: run/run_0.mcap, ... with metadata.yaml next to the files.
class OutputFiles {
 public:
  OutputFiles(const std::string& output, bool split);

  /// This output, or the first of run.1.mcap, run.2.mcap, ... that has no files yet.
  static OutputFiles free_beside(const std::string& output, bool split);

  std::filesystem::path file(std::size_t number) const;
  const std::filesystem::path& folder() const { return folder_; }
  /// Of a recording of several files, or in its own folder. One named file needs none; the folder is the user's.
  std::filesystem::path metadata() const { return numbered_ ? folder_ / "metadata.yaml" : std::filesystem::path(); }
  /// The files of an earlier recording under this name.
  std::vector<std::filesystem::path> existing() const;
  /// True when metadata.yaml does not exist, or is that of a rosbag2 recording and lists only files of this one.
  bool owns_metadata() const;

 private:
  bool is_ours(const std::string& file_name) const;

  std::filesystem::path folder_;
  std::string stem_;
  bool numbered_;
};

/// When a new file begins. Both 0: never.
struct SplitPolicy {
  std::uint64_t bytes = 0;        ///< a file does not grow beyond this, unless one message does
  std::uint64_t duration_ns = 0;  ///< between the first and the last message of a file

  bool on() const { return bytes > 0 || duration_ns > 0; }
  /// Whether a file of that size, whose first message has that time, has room for one more message.
  bool has_room(std::uint64_t file_bytes, std::uint64_t message_bytes, std::uint64_t first_ns,
                std::uint64_t now_ns) const;
};

/// Parses "500MB", "1GiB", "60s", "5min", "1h"; empty for other texts.
std::optional<SplitPolicy> parse_split(const std::string& text);

}  // namespace rtd::recorder
