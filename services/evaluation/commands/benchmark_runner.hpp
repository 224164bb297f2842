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

/// A program to run.
struct ProgramTask {
  std::vector<std::string> command;
  /// Tasks with the same word wait until one of them has ended well: it makes what the others use. Empty: waits for
  /// none.
  std::string first_of;
};

/// How one ended, and the last lines that it printed.
struct ProgramResult {
  std::size_t task = 0;  ///< index
  process::ProcessExit exit;
  double duration_s = 0;
  std::vector<std::string> lines;
};

/// Runs all tasks, at most `jobs` beside each other, in their order as far as `first_of` allows. `on_done` is called
/// after each, on this thread. A signal ends those that run, without a call; false then. Throws process::ProcessError
/// when a program cannot be started.
bool run_programs(const std::vector<ProgramTask>& tasks, int jobs, service::InterruptSignals& signals,
                  const std::function<void(const ProgramResult&)>& on_done);

}  // namespace rtd::eval
