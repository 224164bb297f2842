// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <opencv2/core/ocl.hpp>
#include <regex>
#include <string>
#include <vector>

#include "services/detector/core/engine.hpp"

namespace rtd::test {

/// Why OpenCL cannot be tested here; empty when it can. PoCL compiles for the CPU: version 3 (Debian 12) in seconds,
/// version 6 (Debian 13) not within five minutes.
inline std::string opencl_unavailable() {
  if (detector::opencl_devices().empty()) return "needs an OpenCL device: apt-get install pocl-opencl-icd";
  std::vector<cv::ocl::PlatformInfo> platforms;
  cv::ocl::getPlatfomsInfo(platforms);
  const std::regex slow("PoCL ([4-9]|[1-9][0-9])\\.");
  const bool compiles_slowly =
      std::ranges::any_of(platforms, [&](const auto& platform) { return std::regex_search(platform.version(), slow); });
  return compiles_slowly ? "this version of PoCL compiles for many minutes" : "";
}

}  // namespace rtd::test
