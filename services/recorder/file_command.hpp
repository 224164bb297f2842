// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace rtd::recorder {

/// Runs `rtd-record NAME ...`, a command on files instead of a service: parses what follows the name, then works.
/// Returns the exit code: that of `work`, 2 for wrong options and files that cannot be used, 1 for other failures.
int run_file_command(CLI::App& app, int argc, char** argv, const std::function<int()>& work);

}  // namespace rtd::recorder
