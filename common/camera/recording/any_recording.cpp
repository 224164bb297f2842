// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "common/camera/recording/recording.hpp"

namespace rtd::camera {

std::unique_ptr<Recording> open_any(const std::filesystem::path& path) {
  std::string begin(16, '\0');
  std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin.starts_with("#ROSBAG V2.0")) return open_bag(path);
  return begin.starts_with("SQLite format 3") ? open_db3(path) : open_mcap(path);
}

}  // namespace rtd::camera
