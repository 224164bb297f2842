// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtd::launcher {

/// Adds the commands that are executables of their own to the help of `app`, and those that are installed but not ours.
void list_external_commands(CLI::App& app);

/// Becomes the executable of `rtd NAME`: a known one, else rtd-NAME. Returns only when that fails, with the exit code:
/// the message says which CMake target builds it or, for an unknown name, which command is nearest to it.
int run_external_command(const std::string& name, const std::vector<std::string>& arguments,
                         const std::vector<std::string>& built_in);

}  // namespace rtd::launcher
