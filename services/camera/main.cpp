// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <string>

#include "common/camera/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/camera/tum/tum_export.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/run_service.hpp"
#include "services/camera/camera_service.hpp"
#include "services/camera/preview_command.hpp"

namespace rtd::camera {
namespace {

/// Whether the command line asks for `rtd-camera --export FOLDER` instead of a service.
bool wants_export(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](const std::string& argument) {
    return argument == "--export" || argument.starts_with("--export=");
  });
}

/// `rtd-camera --export FOLDER --source URI [--frames N]`: no bus, no service. Returns the exit code.
int run_export(int argc, char** argv) {
  std::string folder, uri;
  std::uint64_t frames = 0;
  CLI::App app{"Write a source to a new folder in TUM's layout", "rtd-camera"};
  app.add_option("--export", folder, "New folder")->required();
  app.add_option("--source", uri, stored_source_forms())->required();
  app.add_option("--frames", frames, "At most this many frames, 0 = all");
  return service::run_command(app, argc, argv, [&]() -> int {
    try {
      const std::unique_ptr<FrameSource> source = make_source(uri);
      std::cout << export_tum(*source, folder, frames) << " frames written to " << folder << '\n';
      return service::kOk;
    } catch (const SourceError& error) {
      std::cerr << "rtd-camera: " << error.what() << '\n';
      return service::kUsageOrConfig;
    } catch (const std::exception& error) {
      std::cerr << "rtd-camera: " << error.what() << '\n';
      return service::kRunFailed;
    }
  });
}

}  // namespace
}  // namespace rtd::camera

int main(int argc, char** argv) {
  if (rtd::camera::wants_export(argc, argv)) return rtd::camera::run_export(argc, argv);
  if (rtd::camera::wants_preview(argc, argv)) return rtd::camera::run_preview(argc, argv);
  return rtd::service::run_service<rtd::camera::CameraService>(argc, argv);
}
