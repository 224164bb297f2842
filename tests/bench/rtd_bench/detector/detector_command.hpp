// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>
#include <optional>
#include <string>

#include "tests/bench/rtd_bench/detector/detector_bench.hpp"

namespace rtd::bench {

/// The options of `rtd bench detector`.
struct DetectorRequest {
  DetectorOptions options;
  std::string model;         ///< file, or a name that service::find_model() looks for; empty: the usual one
  std::string image_folder;  ///< empty: the rendered office
  std::size_t frames = 32;   ///< images at most
  FleetLoad load;            ///< robots to be served
  std::string json_file;
};

void add_detector_command(CLI::App& app, DetectorRequest& request);
/// Runs the command if it was parsed; its exit code: 0; 1 when a case gave no figures; 2 for a model, images, files or
/// an engine's name that cannot be used.
std::optional<int> run_detector(const CLI::App& app, DetectorRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rtd::bench
