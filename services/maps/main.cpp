// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/service/command_line.hpp"
#include "services/maps/map_command.hpp"
#include "services/maps/scene_export.hpp"

int main(int argc, char** argv) {
  rtd::maps::MapRequest request;
  rtd::maps::SceneRequest scene;
  CLI::App app{"What a map file of slam contains; export of its landmarks and keyframe poses, and of whole runs",
               "rtd map"};
  rtd::maps::add_map_commands(app, request);
  rtd::maps::add_scene_command(app, scene);
  return rtd::service::run_command(app, argc, argv, [&] {
    return app.got_subcommand("scene") ? rtd::maps::export_scene(scene, std::cout, std::cerr)
                                       : rtd::maps::run_map(request, std::cout, std::cerr);
  });
}
