// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace rtd::test_support {

/// tum: URI of a clip below RTD_DATA_DIR; empty when it is not there.
inline std::string clip_uri(const std::string& name, const std::string& parameters = {}) {
  const char* folder = std::getenv("RTD_DATA_DIR");
  if (folder == nullptr || !std::filesystem::exists(std::filesystem::path(folder) / name)) return {};
  return "tum:" + (std::filesystem::path(folder) / name).string() + parameters;
}

}  // namespace rtd::test_support
