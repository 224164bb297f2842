// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/service/bus_config.hpp"
#include "services/evaluation/core/ablation/ablation.hpp"

namespace CLI {
class App;
}

namespace rtd::eval {

/// The command line of `rtd ablate`.
struct AblateOptions {
  std::vector<std::string> sources;
  int runs = 1;
  std::string pace = "lockstep";
  std::vector<std::string> modes;    ///< empty: all
  std::vector<std::string> without;  ///< techniques to switch off, each alone; empty: all; "none"
  std::string out_dir = "rtd_ablation";
  service::ConfigSources config;
  std::string detector = "auto", model;
  std::uint64_t frames = 0;  ///< of each run; 0 = all
  bool json = false;         ///< JSON on standard output instead of the table
  bool resume = false;       ///< keep finished runs of the same settings in out_dir
};

void add_ablate_command(CLI::App& app, AblateOptions& options);

/// `rtd ablate`: every mode, then mode rtd without each technique, on every source, each with `rtd run`. Writes
/// ablation.json, .md and .html after every run. Returns the exit code: 0; 1 when a run failed; 2 when nothing could be
/// started; 130 when interrupted.
int run_ablate(const AblateOptions& options);

}  // namespace rtd::eval
