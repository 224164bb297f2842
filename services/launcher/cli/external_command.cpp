// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/cli/external_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>

#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "services/launcher/process/executable.hpp"

namespace rtd::launcher {
namespace {

struct ExternalCommand {
  const char* name;        ///< "info" of `rtd info`
  const char* executable;  ///< "rtd-recording"; also the CMake target that builds it
  const char* help;
  const char* group = "Services";
  const char* subcommand = nullptr;  ///< what the executable calls it, if not `name`

  /// An executable with several commands gets the command as its first argument.
  std::vector<std::string> first_argument() const {
    if (subcommand != nullptr) return {subcommand};
    return std::string("rtd-") + name == executable ? std::vector<std::string>{} : std::vector<std::string>{name};
  }
};

constexpr const char* kTools = "Tools";
constexpr std::array kCommands = {
    ExternalCommand{"eval", "rtd-eval", "Compare a trajectory with its ground truth (both in TUM format)", kTools,
                    "trajectory"},
    ExternalCommand{"eval-detector", "rtd-eval", "Measure precision, recall and time of detector models", kTools,
                    "detector"},
    ExternalCommand{"ablate", "rtd-eval", "Compare all filter modes, and mode rtd without each technique", kTools},
    ExternalCommand{"report", "rtd-eval", "Write the report of a run again, from its run.json", kTools},
    ExternalCommand{"info", "rtd-recording", "Show what a recording (MCAP) contains: topics, rates, losses, damage",
                    kTools},
    ExternalCommand{"diff", "rtd-recording", "Compare two recordings (MCAP) or two trajectories (TUM format)", kTools},
    ExternalCommand{"convert", "rtd-recording", "Convert a bag, an MCAP file or a TUM folder to TUM or MCAP", kTools},
    ExternalCommand{"map", "rtd-map", "Show what a map file contains; export its landmarks or keyframe poses", kTools},
    ExternalCommand{"topics", "rtd-topics", "List the topics of a DDS domain, measure rates, print messages", kTools},
    ExternalCommand{"keystore", "rtd-keystore", "Create and renew the keys for --secure", kTools},
    ExternalCommand{"bench", "rtd-bench", "Measure feature extraction and transport beside a reference", kTools},
    ExternalCommand{"camera", "rtd-camera", "Publish the frames of a source"},
    ExternalCommand{"detector", "rtd-detector", "Detect people and objects in images"},
    ExternalCommand{"filter", "rtd-filter", "Extract features and find those on moving objects"},
    ExternalCommand{"slam", "rtd-slam", "Track the camera and build the map"},
    ExternalCommand{"dense", "rtd-dense", "Fuse a dense static map"},
    ExternalCommand{"record", "rtd-record", "Record topics to MCAP files; recover and join recordings"},
    ExternalCommand{"replay", "rtd-replay", "Replay a recording"},
};

const ExternalCommand* find_command(const std::string& name) {
  const auto found = std::ranges::find(kCommands, name, &ExternalCommand::name);
  return found == kCommands.end() ? nullptr : &*found;
}

/// The names of installed executables rtd-NAME that the table does not have.
std::vector<std::string> other_commands() {
  std::vector<std::string> names = installed_commands();
  std::erase_if(names, [](const std::string& name) {
    const std::string executable = "rtd-" + name;
    return std::ranges::count(kCommands, executable, &ExternalCommand::executable) > 0;
  });
  return names;
}

std::string unknown_command(const std::string& name, std::vector<std::string> known) {
  for (const ExternalCommand& command : kCommands) known.emplace_back(command.name);
  for (const std::string& other : other_commands()) known.push_back(other);
  const std::string near = service::nearest_name(name, known);
  return "'" + name + "' is not an rtd command" +
         (near.empty() ? "; 'rtd --help' lists all commands" : ", did you mean '" + near + "'?");
}

}  // namespace

void list_external_commands(CLI::App& app) {
  for (const ExternalCommand& command : kCommands) app.add_subcommand(command.name, command.help)->group(command.group);
  app.footer([] {
    std::string text = "'rtd COMMAND --help' shows the options of a command.";
    for (const std::string& name : other_commands()) text += "\n  also installed: rtd " + name;
    return text;
  });
}

int run_external_command(const std::string& name, const std::vector<std::string>& arguments,
                         const std::vector<std::string>& built_in) {
  const ExternalCommand* command = find_command(name);
  const std::string target = command == nullptr ? "rtd-" + name : command->executable;
  const std::string executable = find_executable(target);
  if (executable.empty()) {
    std::cerr << "rtd: " << (command == nullptr ? unknown_command(name, built_in) : missing_executable(target)) << '\n';
    return service::kUsageOrConfig;
  }
  std::vector<std::string> all = command == nullptr ? std::vector<std::string>{} : command->first_argument();
  all.insert(all.end(), arguments.begin(), arguments.end());
  const std::string failure = replace_process(executable, all);
  std::cerr << "rtd: " << failure << '\n';
  return service::kRunFailed;
}

}  // namespace rtd::launcher
