// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "common/service/exit_code.hpp"
#include "services/launcher/cli/external_command.hpp"
#include "services/launcher/demo/demo_command.hpp"
#include "services/launcher/doctor/doctor_command.hpp"
#include "services/launcher/run/run_command.hpp"

namespace rtd::launcher {
namespace {

const std::vector<std::string> kBuiltIn = {"run", "demo", "doctor", "version", "help"};

struct Requests {
  RunOptions run;
  DemoOptions demo;
  DoctorOptions doctor;
};

void add_run_command(CLI::App& app, RunOptions& options) {
  CLI::App* command = app.add_subcommand("run", "Run camera, detector, filter and slam on a source and report");
  command
      ->add_option("--source", options.source,
                   "tum:FOLDER, bag:FILE, mcap:FILE, ros2:COLOR,DEPTH[,INFO] or synthetic:NAME[?seed=..&frames=..]")
      ->required();
  command->add_option("--out", options.out_dir, "Folder for trajectory, map, logs and report")->required();
  command->add_option("--pace", options.pace, "realtime, asap or lockstep")
      ->check(CLI::IsMember({"realtime", "asap", "lockstep"}))
      ->capture_default_str();
  command
      ->add_option("--filter", options.filter_mode, "off, semantic, geometry, epipolar, rtd-paper or rtd (default rtd)")
      ->check(CLI::IsMember(kFilterModes));
  service::add_bus_options(*command, options.bus);
  command->add_option("--dds-of", options.dds_of,
                      "Another DDS for one service, e.g. detector=cyclonedds (repeatable); all vendors interoperate");
  command->add_option("--config", options.config_file, "YAML file with a section per service")
      ->check(CLI::ExistingFile);
  command->add_option("--set", options.overrides, "Override one key, e.g. --set filter.mode=geometry (repeatable)");
  command
      ->add_option("--detector", options.detector,
                   "auto: if weights are found; off: geometry only; remote: on another host")
      ->check(CLI::IsMember({"auto", "off", "remote"}))
      ->capture_default_str();
  command->add_option("--model", options.model,
                      "Detector weights, ONNX (default: RTD_MODEL_DIR, then the user's cache)");
  command->add_option("--frames", options.frames, "End after this many frames");
  command->add_option("--map", options.map, "Continue the map in this file");
  command->add_option("--save-map", options.save_map, "Map file to write (default: map.rtdmap in the folder of --out)");
  command->add_flag("--localize-only", options.localize_only,
                    "Only find poses in the map of --map, leave it unchanged");
  command->add_flag("--dense", options.dense, "Also fuse a dense static map: static_map.ply");
  command->add_option("--record", options.record,
                      "Also record all topics: FILE.mcap, or a folder in the layout of rosbag2");
  command
      ->add_option(
          "--replay-topics", options.replay_topics,
          "With --source mcap:FILE: use recorded detections or features instead of detector, or detector and filter")
      ->delimiter(',')
      ->check(CLI::IsMember({"detections", "features"}));
  command->add_flag("--quiet", options.quiet, "Only warnings and errors");
}

void add_demo_command(CLI::App& app, DemoOptions& options) {
  CLI::App* command = app.add_subcommand("demo", "Run the same scene without and with removal of dynamic points");
  command->add_option("--dataset", options.dataset, "TUM RGB-D sequence to download, e.g. fr3_walking_xyz");
  command->add_option("--out", options.out_dir, "Folder for both runs and demo.html")->capture_default_str();
  command->add_option("--frames", options.frames, "End after this many frames");
  service::add_bus_options(*command, options.bus);
}

void add_doctor_command(CLI::App& app, DoctorOptions& options) {
  CLI::App* command = app.add_subcommand(
      "doctor", "Check this host for a run with these options: services, memory, network, keys, weights, data");
  command->add_flag("--clean", options.clean, "Remove what killed processes left in /dev/shm");
  service::add_bus_options(*command, options.bus);
  command->add_option("--config", options.config.file, "YAML file with a section per service")
      ->check(CLI::ExistingFile);
  command->add_option("--set", options.config.overrides, "Override one key of bus, e.g. --set bus.domain=5");
}

int dispatch(const CLI::App& app, const Requests& requests) {
  if (app.got_subcommand("run")) return run(requests.run).code;
  if (app.got_subcommand("demo")) return demo(requests.demo);
  if (app.got_subcommand("doctor")) return doctor(requests.doctor, std::cout, std::cerr);
  if (app.got_subcommand("version")) {
    std::cout << "rtd " << RTD_VERSION << '\n';
    return service::kOk;
  }
  std::cout << app.help();
  return service::kOk;
}

/// The command `rtd`: its own commands, and those of other executables. Returns the exit code.
int front(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool named = !arguments.empty() && !arguments[0].empty() && arguments[0][0] != '-';
  if (named && std::ranges::count(kBuiltIn, arguments[0]) == 0)
    return run_external_command(arguments[0], {arguments.begin() + 1, arguments.end()}, kBuiltIn);

  Requests requests;
  CLI::App app{"RTD-SLAM: RGB-D SLAM that stays accurate when people walk through the view", "rtd"};
  add_run_command(app, requests.run);
  add_demo_command(app, requests.demo);
  add_doctor_command(app, requests.doctor);
  app.add_subcommand("version", "Print the version");
  app.add_subcommand("help", "Print this text");
  for (CLI::App* command : app.get_subcommands({})) command->group("Commands");
  list_external_commands(app);
  app.set_version_flag("--version", std::string("rtd ") + RTD_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? service::kOk : service::kUsageOrConfig;
  }
  return dispatch(app, requests);
}

}  // namespace
}  // namespace rtd::launcher

int main(int argc, char** argv) {
  return rtd::launcher::front(argc, argv);
}
