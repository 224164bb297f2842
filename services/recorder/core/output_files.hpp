// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rtd::recorder {

/// Where a recording goes. "run.mcap" is that file, or run_0.mcap, run_1.mcap, ... when it is split. Anything else is a
/// folder as rosbag2 has it: run/run_0.mcap, ... Beside the files lies metadata.yaml.
class OutputFiles {
 public:
  OutputFiles(const std::string& output, bool split);

  /// This output, or the first of run.1.mcap, run.2.mcap, ... that has no files yet.
  static OutputFiles free_beside(const std::string& output, bool split);

  std::filesystem::path file(std::size_t number) const;
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path metadata() const { return folder_ / "metadata.yaml"; }
  /// Files of an earlier recording under this name that are there now.
  std::vector<std::filesystem::path> existing() const;
  /// Whether metadata.yaml is not there or speaks of files of this recording only.
  bool owns_metadata() const;

 private:
  bool is_ours(const std::string& file_name) const;

  std::filesystem::path folder_;
  std::string stem_;
  bool numbered_;
};

}  // namespace rtd::recorder
