// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/command_line.hpp"

#include <CLI/CLI.hpp>

#include "common/service/exit_code.hpp"

namespace rtd::service {

int run_command(CLI::App& app, int argc, char** argv, const std::function<int()>& work) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsageOrConfig;
  }
  return work();
}

}  // namespace rtd::service
