// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "common/camera/live_uri.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/run_service.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/camera/camera_service.hpp"
#include "services/camera/core/preview.hpp"
#include "services/camera/live_camera.hpp"

namespace rtd::camera {
namespace {

struct PreviewOptions {
  std::string source, picture = "preview.png";
  double seconds = 3;
  service::ConfigSources bus;
};

std::unique_ptr<FrameSource> open_for_preview(const PreviewOptions& options) {
  constexpr std::int64_t kOpenTimeoutNs = 10'000'000'000;
  const std::string uri = complete_uri(options.source);
  if (!is_live(uri)) return make_source(uri);
  const bus::BusOptions bus = service::load_bus_options(options.bus, "rtd-camera-preview");
  return make_live_source(uri, bus, kOpenTimeoutNs, [said = std::string()](const std::string& what) mutable {
    if (!what.empty() && what != said) std::cerr << "rtd-camera: " << what << '\n';
    said = what;
  });
}

/// Frames of so many seconds by their stamps.
Preview play(FrameSource& source, double seconds) {
  Preview preview;
  std::optional<std::int64_t> until_ns;
  while (const std::optional<SourceFrame> frame = source.next()) {
    const std::int64_t stamp_ns = frame->image.stamp_ns;
    if (!until_ns) until_ns = stamp_ns + static_cast<std::int64_t>(seconds * 1e9);
    if (stamp_ns > *until_ns) break;
    preview.add(*frame);
  }
  return preview;
}

int preview(const PreviewOptions& options) {
  const std::unique_ptr<FrameSource> source = open_for_preview(options);
  source->open();
  const Preview measured = play(*source, options.seconds);
  if (measured.frames() == 0) {
    std::cerr << "rtd-camera: " << options.source << " gives no frame\n";
    return service::kRunFailed;
  }
  std::cout << measured.text(source->info(), source->counters());
  if (!vision::write_image(options.picture, measured.picture(), {.named_by = io::NamedBy::kOperator})) {
    std::cerr << "rtd-camera: " << options.picture << " cannot be written: choose another file with --picture\n";
    return service::kRunFailed;
  }
  std::cout << "picture       " << options.picture << '\n';
  return service::kOk;
}

/// Whether the command line asks for a preview instead of a service.
bool wants_preview(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](const std::string& argument) { return argument == "--preview"; });
}

/// `rtd-camera --preview --source URI [--seconds 3] [--picture preview.png] [bus options]`: plays the source for a
/// while, prints its figures and writes a picture. Publishes nothing. Returns the exit code: 1 when no frame came.
int run_preview(int argc, char** argv) {
  PreviewOptions options;
  bool asked = false;
  CLI::App app{"Measure what a source delivers and write a picture of it", "rtd-camera"};
  app.add_flag("--preview", asked, "Print rate, size, share of holes and offset of depth against colour");
  app.add_option("--source", options.source, "The camera, as for a run (`rtd doctor` lists cameras)")->required();
  app.add_option("--seconds", options.seconds, "Of the source to measure")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--picture", options.picture, "PNG or JPEG file: colour to go with depth")->capture_default_str();
  service::add_bus_options(app, options.bus);
  return service::run_command(app, argc, argv, [&]() -> int {
    try {
      return preview(options);
    } catch (const SourceError& error) {
      std::cerr << "rtd-camera: " << error.what() << '\n';
      return is_live(complete_uri(options.source)) ? service::kRunFailed : service::kUsageOrConfig;
    } catch (const service::ConfigError& error) {
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
  if (rtd::camera::wants_preview(argc, argv)) return rtd::camera::run_preview(argc, argv);
  return rtd::service::run_service<rtd::camera::CameraService>(argc, argv);
}
