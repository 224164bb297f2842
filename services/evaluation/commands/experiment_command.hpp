// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/process/process_host.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/command_line.hpp"

namespace CLI {
class App;
}

namespace rtd::eval {

/// The command of a program, which has one of the places 0 .. jobs - 1 while it runs.
using ProgramTask = std::function<std::vector<std::string>(int place)>;

/// How one ended, and the last line that it printed.
struct ProgramResult {
  std::size_t task = 0;  ///< index
  process::ProcessExit exit;
  double duration_s = 0;
  std::string last_line;
};

/// Runs all tasks in their order, at most `jobs` next to each other; what they print goes to standard error. `on_done`
/// is called after each, on this thread. A signal ends those that run, without a call; false then. Throws
/// process::ProcessError when a program cannot be started.
bool run_programs(const std::vector<ProgramTask>& tasks, int jobs, service::InterruptSignals& signals,
                  const std::function<void(const ProgramResult&)>& on_done);

/// The command line of `rtd ablate` (with sources) or `rtd benchmark` (with a dataset).
struct ExperimentOptions {
  std::vector<std::string> sources;
  std::vector<std::string> without;  ///< techniques to switch off, each alone; empty: all; "none"
  std::string dataset;               ///< tum, bonn, openloris
  std::vector<std::string> folders;  ///< searched for its sequences

  int runs = 1, jobs = 1;
  std::string pace = "lockstep";
  std::vector<std::string> modes;  ///< empty: all
  std::string out_dir;             ///< empty: rtd_benchmark_<dataset>
  std::string compare;             ///< file of results; empty: none
  service::ConfigSources config;
  std::string detector = "auto", model;
  std::uint64_t frames = 0;  ///< of each run; 0 = all
  bool json = false;         ///< JSON on standard output instead of the table
  bool resume = false;       ///< keep runs of the same settings in out_dir

  bool is_benchmark() const { return !dataset.empty(); }
};

void add_ablate_command(CLI::App& app, ExperimentOptions& options);
void add_benchmark_command(CLI::App& app, ExperimentOptions& options);

/// `rtd ablate`: every mode, then mode rtd without each technique, on every source. `rtd benchmark`: every mode on
/// every sequence of a public dataset, several perturbed runs each. Each run is an `rtd run`. Writes ablation or
/// benchmark.json, .md and .html after every run. Returns the exit code: 0; 1 when a run failed; 2 when nothing could
/// be started; 3 when sequences were left out; 130 when interrupted.
int run_experiment(ExperimentOptions options);

}  // namespace rtd::eval
