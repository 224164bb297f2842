// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/topic_roles.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/services.hpp"
#include "common/process/executable.hpp"
#include "common/ros2/names.hpp"
#include "common/service/bus_config.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/standard_streams.hpp"
#include "services/launcher/core/completion/completion.hpp"
#include "services/launcher/demo/demo_command.hpp"
#include "services/launcher/doctor/doctor_command.hpp"
#include "services/launcher/run/run_command.hpp"

namespace rtd::launcher {
namespace {

const std::vector<std::string> kBuiltIn = {"run", "demo", "doctor", "version", "help", "complete"};

struct ExternalCommand {
  const char* name;        ///< "info" of `rtd info`
  const char* executable;  ///< "rtd-recording"; also the CMake target that builds it
  const char* help;
  const char* group = "Tools";
  const char* subcommand = nullptr;  ///< what the executable calls it, if not `name`

  /// An executable with several commands gets the command as its first argument.
  std::vector<std::string> first_argument() const {
    if (subcommand != nullptr) return {subcommand};
    return std::string("rtd-") + name == executable ? std::vector<std::string>{} : std::vector<std::string>{name};
  }
};

constexpr std::array kToolCommands = {
    ExternalCommand{"eval", "rtd-eval", "Compare a trajectory with its ground truth (TUM, KITTI, EuRoC, recordings)",
                    "Tools", "trajectory"},
    ExternalCommand{"eval-detector", "rtd-eval", "Measure precision, recall and time of detector models", "Tools",
                    "detector"},
    ExternalCommand{"ablate", "rtd-eval", "Compare all filter modes, and mode rtd without each technique"},
    ExternalCommand{"benchmark", "rtd-eval", "Run all modes on TUM, Bonn or OpenLORIS data"},
    ExternalCommand{"report", "rtd-eval", "Write the report of a run again, from its run.json"},
    ExternalCommand{"info", "rtd-recording", "Show what a recording contains: topics, rates, losses, damage"},
    ExternalCommand{"diff", "rtd-recording", "Compare two recordings"},
    ExternalCommand{"convert", "rtd-recording",
                    "Convert a recording with all its topics to MCAP, or frames to TUM or MCAP"},
    ExternalCommand{"map", "rtd-map", "Show what a map file contains; export its landmarks or keyframe poses"},
    ExternalCommand{"export", "rtd-map", "Export a run for Gaussian splatting: COLMAP, nerfstudio, masks of what moves",
                    "Tools", "scene"},
    ExternalCommand{"topics", "rtd-topics",
                    "List the topics of a DDS domain, measure rates, print messages, also of a recording"},
    ExternalCommand{"call", "rtd-topics", "Call a command of a running service: reset the map, pause a replay, ..."},
    ExternalCommand{"keystore", "rtd-keystore", "Create and renew the keys for --secure"},
    ExternalCommand{"bench", "rtd-bench", "Measure feature extraction, transport and detector engines"},
};

/// The tools, then the services.
const std::vector<ExternalCommand>& commands() {
  static const std::vector<ExternalCommand> all = [] {
    std::vector<ExternalCommand> list(kToolCommands.begin(), kToolCommands.end());
    for (const msg::NamedService& service : msg::kServices)
      list.push_back({service.name, service.executable, service.help, "Services"});
    return list;
  }();
  return all;
}

/// The names of installed executables rtd-NAME that the table does not have.
std::vector<std::string> other_commands() {
  std::vector<std::string> names = process::installed_commands();
  std::erase_if(names, [](const std::string& name) {
    const std::string executable = "rtd-" + name;
    return std::ranges::count(commands(), executable, &ExternalCommand::executable) > 0;
  });
  return names;
}

std::string unknown_command(const std::string& name) {
  std::vector<std::string> known = kBuiltIn;
  for (const ExternalCommand& command : commands()) known.emplace_back(command.name);
  for (const std::string& other : other_commands()) known.push_back(other);
  const std::string near = io::nearest_name(name, known);
  return "'" + io::abridged(name) + "' is not an rtd command" +
         (near.empty() ? "; 'rtd --help' lists all commands" : ", did you mean '" + near + "'?");
}

/// Adds the commands that are executables of their own to the help of `app`, and those that are installed but not ours.
void list_external_commands(CLI::App& app) {
  for (const ExternalCommand& command : commands())
    app.add_subcommand(command.name, command.help)->group(command.group);
  app.footer([] {
    std::string text = "'rtd COMMAND --help' shows the options of a command.";
    for (const std::string& name : other_commands()) text += "\n  also installed: rtd " + name;
    return text;
  });
}

/// Becomes the executable of `rtd NAME`: a known one, else rtd-NAME. Returns only when that fails, with the exit code:
/// the message says which CMake target builds it or, for an unknown name, which command is nearest to it.
int run_external_command(const std::string& name, std::vector<std::string> arguments) {
  const auto command = std::ranges::find(commands(), name, &ExternalCommand::name);
  const bool known = command != commands().end();
  const std::string target = known ? command->executable : "rtd-" + name;
  const std::string executable = process::find_executable(target);
  if (executable.empty()) {
    std::cerr << "rtd: " << (known ? process::missing_executable(target) : unknown_command(name)) << '\n';
    return service::kUsageOrConfig;
  }
  const std::vector<std::string> first = known ? command->first_argument() : std::vector<std::string>{};
  arguments.insert(arguments.begin(), first.begin(), first.end());
  const std::string problem = process::replace_process(executable, arguments);  // returns only when it fails
  std::cerr << "rtd: " << problem << '\n';
  return service::kRunFailed;
}

/// `rtd replay --viewer`: starts the viewer where the replay will publish, and replaces the option among the arguments
/// by what the replay has to do for it. The viewer ends with the replay. Throws service::ConfigError.
void start_viewer(std::vector<std::string>& arguments) {
  const std::string flag = "--viewer";
  const auto given = std::ranges::find_if(
      arguments, [&](const std::string& argument) { return argument == flag || argument.starts_with(flag + '='); });
  if (given == arguments.end()) return;
  const ViewerUse use = parse_viewer_use(given->size() > flag.size() ? given->substr(flag.size() + 1) : "");
  arguments.erase(given);
  const std::string executable = process::require_executable("rtd-viewer");
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  service::ConfigSources sources;
  service::add_source_options(app, sources);
  service::add_bus_options(app, sources);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError&) {
    return;  // the replay says what is wrong
  }
  if (use.waits) arguments.emplace_back("--wait-page");
  if (use.stays) arguments.emplace_back("--hold");
  std::vector<std::string> command = service::to_command_line(sources);
  command.insert(command.end(), {"--log-level", "warning", "--open"});
  const std::string problem = process::start_companion(executable, command);
  if (!problem.empty()) throw service::ConfigError(problem);
}

/// `rtd complete WORD...`: prints the candidates for the last word, for the shells' scripts (deploy/completion).
int complete_words(const std::vector<std::string>& words) {
  CompletionSources sources;
  for (const std::string& name : kBuiltIn)
    if (name != "complete") sources.commands.push_back(name);
  for (const ExternalCommand& command : commands()) sources.commands.emplace_back(command.name);
  for (const std::string& other : other_commands()) sources.commands.push_back(other);
  for (const msg::NamedService& service : msg::kServices) sources.services.emplace_back(service.name);
  for (const bus::TopicRoles& topic : bus::topic_roles())
    if (topic.topic.find('*') == std::string::npos) sources.topics.push_back(ros2::ros_topic(topic.topic));
  const auto is_known = [&](const std::string& name) { return std::ranges::count(sources.commands, name) > 0; };
  sources.help = [&](const std::vector<std::string>& command) -> std::string {
    if (!is_known(command.front())) return "";
    std::vector<std::string> arguments = command;
    arguments.emplace_back("--help");
    return process::output_of(process::find_executable("rtd"), arguments);
  };
  sources.config = [&](const std::string& service) {
    return is_known(service) ? process::output_of(process::find_executable("rtd"), {service, "--print-config"}) : "";
  };
  for (const std::string& candidate : complete(words, sources)) std::cout << candidate << '\n';
  return service::kOk;
}

struct Requests {
  RunOptions run;
  DemoOptions demo;
  DoctorOptions doctor;
};

void add_run_command(CLI::App& app, RunOptions& options) {
  CLI::App* command = app.add_subcommand("run", "Run camera, detector, filter and slam on a source and report");
  command->option_defaults()->group("Source");
  command->add_option("--source", options.source, camera::source_help())->required();
  command->add_option("--frames", options.frames, "End after this many frames");
  command
      ->add_option("--pace", options.pace,
                   "lockstep: every frame, the same result each time; asap: every frame, faster; realtime: by the "
                   "stamps, late frames are dropped. Default: lockstep for files, folders and scenes with an end, "
                   "realtime for cameras")
      ->check(CLI::IsMember({"realtime", "asap", "lockstep"}));
  command
      ->add_option(
          "--replay-topics", options.replay_topics,
          "With --source mcap:FILE: use recorded detections or features instead of detector, or detector and filter")
      ->delimiter(',')
      ->check(CLI::IsMember({"detections", "features"}));
  command->option_defaults()->group("Results");
  command->add_option("--out", options.out_dir, "Folder for trajectory, map, logs and report")->required();
  command->add_option("--record", options.record,
                      "Also record all topics: FILE.mcap, or a folder in the layout of rosbag2");
  command->add_flag("--blur-people", options.blur_people, "With --record: people in recorded images are pixelated");
  command->add_flag("--viewer", options.viewer,
                    "Also show the run in the browser, until Ctrl-C; a recording waits for the first page. "
                    "--viewer=now does not wait, --viewer=exit ends with the run (--set viewer.port=...)");
  command->add_flag(
      "--dense", options.dense,
      "Also fuse a dense static map, with floor plan and voxel map: static_map.ply, map.pgm, map.yaml, map.bt");
  command->add_option("--trace", options.trace,
                      "Also write what each service did when, for ui.perfetto.dev or chrome://tracing: FILE.json");
  command->add_flag("--quiet", options.quiet, "Only warnings and errors");
  command
      ->add_option("--detector", options.detector,
                   "auto: if weights are found; off: geometry only; remote: on another host")
      ->check(CLI::IsMember({"auto", "off", "remote"}))
      ->capture_default_str()
      ->group("Dynamic points");
  ServiceSettings settings;
  service::ConfigBinder binder;
  settings.bind(binder);
  binder.add_options(*command, options.config.given);
  service::add_bus_options(*command, options.config);
  command
      ->add_option("--dds-of", options.dds_of,
                   "Another DDS for one service, e.g. detector=cyclonedds (repeatable); all vendors interoperate")
      ->group("Network");
  command->option_defaults()->group("Advanced");
  service::add_source_options(*command, options.config);
  command->get_help_ptr()->group("");  // it would bring its group to the top
  command->footer(
      "Examples:\n"
      "  rtd run --source synthetic:office --out /tmp/office --viewer\n"
      "  rtd run --source tum:rgbd_dataset_freiburg3_walking_xyz --out walking\n"
      "  rtd run --source ros2:/camera/color/image_raw,/camera/depth/image_raw --out live --dense");
}

void add_demo_command(CLI::App& app, DemoOptions& options) {
  CLI::App* command = app.add_subcommand("demo", "Run the same scene without and with removal of dynamic points");
  command->add_option("--source", options.source, "Of frames, e.g. tum:FOLDER; default: a synthetic room with people");
  command->add_option("--out", options.out_dir, "Folder for both runs and demo.html")->capture_default_str();
  command->add_option("--frames", options.frames, "End after this many frames");
  service::add_bus_options(*command, options.config);
}

void add_doctor_command(CLI::App& app, DoctorOptions& options) {
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Check this host for a run with these options: services, memory, network, keys, weights, data, cameras");
  command->add_flag("--clean", options.clean, "Remove what killed processes left in /dev/shm");
  service::add_bus_options(*command, options.config);
  service::add_source_options(*command, options.config);
}

int dispatch(const CLI::App& app, const Requests& requests) {
  if (app.got_subcommand("run")) return run(requests.run).code;
  if (app.got_subcommand("demo")) return demo(requests.demo);
  if (app.got_subcommand("doctor")) return doctor(requests.doctor, std::cout, std::cerr);
  if (app.got_subcommand("version")) {
    std::cout << "rtd " << RTD_VERSION << '\n';
    return service::kOk;
  }
  // Not app.help(), which is that of the given command.
  std::cout << app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
  return service::kOk;
}

/// The command `rtd`: its own commands, and those of other executables. Returns the exit code.
int front(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments[0] == "complete") return complete_words({arguments.begin() + 1, arguments.end()});
  const bool named = !arguments.empty() && !arguments[0].empty() && arguments[0][0] != '-';
  if (named && std::ranges::count(kBuiltIn, arguments[0]) == 0) {
    std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
    return service::report_errors<service::ConfigError>("rtd", std::cerr, [&] {
      if (arguments[0] == "replay") start_viewer(rest);
      return run_external_command(arguments[0], rest);
    });
  }

  Requests requests;
  CLI::App app{"RTD-SLAM: RGB-D SLAM that stays accurate when people walk through the view", "rtd"};
  service::wrap_help(app);
  add_run_command(app, requests.run);
  add_demo_command(app, requests.demo);
  add_doctor_command(app, requests.doctor);
  app.add_subcommand("version", "Print the version");
  app.add_subcommand("help", "Print this text");
  for (CLI::App* command : app.get_subcommands({})) command->group("Commands");
  list_external_commands(app);
  app.set_version_flag("--version", std::string("rtd ") + RTD_VERSION);
  try {
    service::parse(app, argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? service::kOk : service::kUsageOrConfig;
  }
  return dispatch(app, requests);
}

}  // namespace
}  // namespace rtd::launcher

int main(int argc, char** argv) {
  rtd::service::prepare_standard_streams();
  return rtd::launcher::front(argc, argv);
}
