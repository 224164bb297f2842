// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/service/command_line.hpp"
#include "services/maps/map_command.hpp"

int main(int argc, char** argv) {
  rtd::maps::MapRequest request;
  CLI::App app{"What a map file of slam contains; export of its landmarks and keyframe poses", "rtd map"};
  rtd::maps::add_map_commands(app, request);
  return rtd::service::run_command(app, argc, argv, [&] { return rtd::maps::run_map(request, std::cout, std::cerr); });
}
