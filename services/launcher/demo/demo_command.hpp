// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/service/bus_config.hpp"

namespace rtd::launcher {

/// The command line of `rtd demo`.
struct DemoOptions {
  std::string source;  ///< URI; empty: RTD_DATA_DIR's walk_xyz, else the synthetic office
  std::string out_dir = "rtd-demo";
  service::ConfigSources config;
  std::uint64_t frames = 0;
};

/// Runs the same source with filter mode off and rtd, compares both with the ground truth. Returns the exit code.
int demo(const DemoOptions& options);

}  // namespace rtd::launcher
