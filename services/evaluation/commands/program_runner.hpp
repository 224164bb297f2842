// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "common/process/process_host.hpp"
#include "common/service/command_line.hpp"

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

}  // namespace rtd::eval
