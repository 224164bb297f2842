// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "services/launcher/config.hpp"
#include "services/launcher/run/replay_setup.hpp"
#include "services/launcher/run/run_options.hpp"

namespace rtd::launcher {

/// A run whose parts have all been found: what is started and with which arguments.
struct RunSetup {
  LauncherConfig launcher;
  bus::BusOptions bus;
  service::BusArguments bus_arguments;            ///< the same, for the services' command lines
  std::map<std::string, std::string> vendors_of;  ///< services that use another DDS
  std::string source;                             ///< URI
  std::uint64_t total_frames = 0;                 ///< 0 = unknown or endless
  std::string pace, filter_mode, out_dir;
  std::string model_path;        ///< empty: no detector in this run
  std::string detector_note;     ///< model file name, or "off (why)"
  bool remote_detector = false;  ///< it runs on another host and is not ours to start
  std::string weights_advice;    ///< the filter mode wants a detector, but there are no weights: where to get them
  std::string map, save_map;     ///< map files that slam reads and writes; empty: none
  bool save_map_asked = false;   ///< the user named the file
  bool localize_only = false;
  bool dense = false;  ///< rtd-dense runs too
  std::string record;  ///< what rtd-record writes; empty: it does not run
  ReplaySetup replay;
  std::uint64_t frame_limit = 0;
  std::string config_file;
  std::vector<std::string> overrides;

  std::string groundtruth_path() const { return out_dir + "/groundtruth.txt"; }
};

/// Checks everything that can be checked before a process is started: source, configuration, weights, output folder (it
/// is created). Throws service::ConfigError or camera::SourceError.
RunSetup prepare_run(const RunOptions& options);

/// Removes what an earlier run left in the output folder. Throws service::ConfigError.
void clear_out_dir(const RunSetup& setup);

/// The services of the run in starting order, the camera or what stands in for it last. Throws service::ConfigError
/// naming an executable that is missing.
std::vector<ServicePlan> plan_services(const RunSetup& setup);

}  // namespace rtd::launcher
