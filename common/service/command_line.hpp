// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace rtd::service {

/// The main function of a tool: parses the command line into what `app` is bound to, then runs `work`. Returns the exit
/// code of `work`; 0 after --help, 2 for a wrong command line.
int run_command(CLI::App& app, int argc, char** argv, const std::function<int()>& work);

}  // namespace rtd::service
