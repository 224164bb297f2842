// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/recording_path.hpp"

#include <algorithm>
#include <cerrno>
#include <string>
#include <vector>

#include "common/mcap/byte_sink.hpp"

namespace rtd::mcap {

namespace fs = std::filesystem;

fs::path recording_path(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return path;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error))
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
  std::ranges::sort(files);
  if (files.size() == 1) return files.front();
  if (files.empty()) throw IoError(EISDIR, path.string() + ": this folder holds no .mcap file");
  throw IoError(EISDIR, path.string() + ": this folder holds " + std::to_string(files.size()) +
                            " .mcap files: name one of them, e.g. " + files.front().string() +
                            ", or join them: rtd record join " + path.string() + " -o FILE");
}

}  // namespace rtd::mcap
