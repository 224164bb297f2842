// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/out_folder.hpp"

#include <filesystem>
#include <system_error>

#include "common/io/byte_sink.hpp"
#include "common/service/config.hpp"

namespace rtd::process {

void make_out_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw service::ConfigError("--out " + folder + ": cannot be created: " + error.message());
}

io::FolderLock take_out_folder(const std::string& folder) {
  make_out_folder(folder);
  try {
    return io::FolderLock(folder);
  } catch (const io::IoError& failure) {
    throw service::ConfigError(std::string("--out ") + failure.what());
  }
}

}  // namespace rtd::process
