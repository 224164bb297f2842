// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/process/process_host.hpp"

namespace rtd::launcher {

/// Processes that end when the test says so.
class FakeHost : public process::ProcessHost {
 public:
  process::ProcessId start(const process::ProcessSpec& spec) override {
    const std::string& name = spec.name;
    if (missing.count(name) != 0) throw process::ProcessError("cannot run " + name + ": No such file or directory");
    started.push_back(name);
    arguments.assign(spec.command.begin() + 1, spec.command.end());
    names[++last_id] = name;
    return last_id;
  }
  std::optional<process::ProcessExit> poll_exit(process::ProcessId process) override {
    const auto found = exits.find(process);
    if (found == exits.end()) return std::nullopt;
    const process::ProcessExit exit = found->second;
    exits.erase(found);
    return exit;
  }
  void terminate(process::ProcessId process) override {
    terminated.push_back(names[process]);
    if (unresponsive.count(names[process]) == 0) exits[process] = {};
  }
  void kill(process::ProcessId process) override {
    killed.push_back(names[process]);
    exits[process] = {0, 9};
  }
  std::uint64_t signs_of_life(process::ProcessId process) const override {
    const auto found = signs.find(names.at(process));
    return found == signs.end() ? 0 : found->second;
  }
  std::chrono::milliseconds waited_for_processor(process::ProcessId process) const override {
    const auto found = waited.find(names.at(process));
    return found == waited.end() ? std::chrono::milliseconds(0) : found->second;
  }
  void end(const std::string& name, process::ProcessExit exit) {
    for (const auto& [process, process_name] : names) {
      if (process_name == name) newest = process;
    }
    exits[newest] = exit;
  }

  std::set<std::string> missing, unresponsive;
  std::vector<std::string> started, terminated, killed;
  std::vector<std::string> arguments;  ///< of the last one started
  std::map<process::ProcessId, std::string> names;
  std::map<std::string, std::uint64_t> signs;               ///< of life, by name
  std::map<std::string, std::chrono::milliseconds> waited;  ///< for a processor, by name
  std::map<process::ProcessId, process::ProcessExit> exits;
  process::ProcessId last_id = 0, newest = 0;
};

}  // namespace rtd::launcher
