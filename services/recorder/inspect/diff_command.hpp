// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "services/recorder/inspect/trajectory_diff.hpp"

namespace CLI {
class App;
}

namespace rtd::recording {

/// What `rtd diff` was asked.
struct DiffRequest {
  std::string a, b;
  bool json = false;
  PoseTolerance tolerance;
  std::vector<std::string> ignore;  ///< recordings: "stamps", "run"
};

/// Adds the subcommand `diff`; parsing fills `request`, which must outlive `parent`.
CLI::App* add_diff_command(CLI::App& parent, DiffRequest& request);

/// Compares two recordings or two trajectories. Returns the exit code: 0 equal; 1 different; 2 when a file cannot be
/// used; 3 when nothing differs in what can be read, but a recording is damaged.
int run_diff(const DiffRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::recording
