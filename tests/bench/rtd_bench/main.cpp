// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/service/command_line.hpp"
#include "common/service/exit_code.hpp"
#include "tests/bench/rtd_bench/detector/detector_command.hpp"
#include "tests/bench/rtd_bench/features_bench.hpp"
#include "tests/bench/rtd_bench/transport/transport_command.hpp"

namespace {

using namespace rtd;

struct Options {
  std::string source = "synthetic:office";
  bench::FeaturesOptions features;
  bool json = false;
  bench::TransportRequest transport;
  bench::DetectorRequest detector;
};

int run_features(const Options& options) {
  try {
    const bool folder = std::filesystem::is_directory(options.source);
    const auto source = camera::make_source(folder ? "tum:" + options.source : options.source);
    service::Progress progress(std::cerr, "frames", options.features.frames);
    const auto result =
        bench::bench_features(*source, options.features, [&](std::uint64_t done) { progress.reach(done); });
    std::cout << (options.json ? bench::features_json(result, options.features, options.source)
                               : bench::features_table(result, options.features, options.source));
    return service::kOk;
  } catch (const camera::SourceError& error) {
    std::cerr << "rtd bench: " << error.what() << '\n';
    return service::kUsageOrConfig;
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Measure single parts beside a reference in the same run", "rtd bench"};
  app.require_subcommand(1);
  CLI::App* features = app.add_subcommand("features", "Our ORB extractor beside cv::ORB on the same frames");
  features->add_option("--source", options.source, rtd::camera::stored_source_forms())->capture_default_str();
  features->add_option("--features", options.features.features, "Features wanted per frame")
      ->check(CLI::Range(100, 1300))
      ->capture_default_str();
  features
      ->add_option("--frames", options.features.frames,
                   "Number of frames at most (they are read before the measurement)")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  features->add_flag("--json", options.json, "Report as JSON");
  bench::add_detector_command(app, options.detector);
  bench::add_transport_commands(app, options.transport);
  app.footer(
      "Exit codes: 0 done, 1 a case gave no figures, 2 a source or model cannot be read or the options are wrong");
  return service::run_command(app, argc, argv, [&] {
    if (const auto code = bench::run_transport(app, options.transport)) return *code;
    if (const auto code = bench::run_detector(app, options.detector, std::cout, std::cerr)) return *code;
    return run_features(options);
  });
}
