// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "common/camera/recording/recording.hpp"
#include "common/io/recording_forms.hpp"

namespace rtd::camera {

std::unique_ptr<Recording> open_any(const std::filesystem::path& path) {
  std::string begin(io::kMagicBytes, '\0');
  std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin.starts_with(io::kBagMagic)) return open_bag(path);
  return begin.starts_with(io::kDb3Magic) ? open_db3(path) : open_mcap(path);
}

}  // namespace rtd::camera
