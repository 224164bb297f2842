// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace rtd::io {

/// File of a library that is loaded only when it is needed and comes with this program: beside it as built, in
/// ../lib/rtd-slam as installed, or in ../bin for tests. Empty when there is none.
inline std::filesystem::path find_own_library(const std::string& name) {
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const auto& folder : {here, here / "../lib/rtd-slam", here / "../bin"}) {
    if (std::filesystem::exists(folder / name, error)) return folder / name;
  }
  return {};
}

}  // namespace rtd::io
