// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/service/command_line.hpp"
#include "services/recorder/convert/convert_command.hpp"
#include "services/recorder/inspect/inspect_commands.hpp"

/// rtd-recording: `rtd info`, `rtd diff` and `rtd convert`.
int main(int argc, char** argv) {
  using namespace rtd;
  recording::InfoOptions info;
  recording::DiffRequest diff;
  recording::ConvertOptions convert;
  CLI::App app{"What recordings contain, how they differ, and their conversion", "rtd"};
  app.require_subcommand(1);
  recording::add_info_command(app, info);
  recording::add_diff_command(app, diff);
  recording::add_convert_command(app, convert);
  return service::run_command(app, argc, argv, [&] {
    if (app.got_subcommand("info")) return recording::run_info(info, std::cout, std::cerr);
    if (app.got_subcommand("diff")) return recording::run_diff(diff, std::cout, std::cerr);
    return recording::run_convert(convert, std::cout, std::cerr);
  });
}
