// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/call_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <ostream>
#include <thread>

#include "common/bus/commands.hpp"
#include "common/bus/port_check.hpp"
#include "common/io/printable.hpp"
#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"

namespace rtd::topics {
namespace {

using namespace std::chrono_literals;
using Cause = bus::CommandError::Cause;
using Clock = std::chrono::steady_clock;

/// Participants announce themselves twice a second.
constexpr auto kSettled = 1s;
constexpr auto kLongestSearch = 3s;

/// Waits until no new command has appeared for a while.
std::vector<bus::FoundCommand> find_commands(const bus::CommandClient& client) {
  const Clock::time_point end = Clock::now() + kLongestSearch;
  Clock::time_point last_new = Clock::now();
  std::vector<bus::FoundCommand> found;
  while (Clock::now() < end && (found.empty() || Clock::now() - last_new < kSettled)) {
    std::this_thread::sleep_for(20ms);
    const std::size_t before = found.size();
    found = client.commands();
    if (found.size() != before) last_new = Clock::now();
  }
  return found;
}

std::string note_of(const bus::FoundCommand& command) {
  if (command.servers > 1) return fmt::format("{} programs offer it", command.servers);
  return command.vendor.empty() ? "cannot be called from here" : "";
}

nlohmann::json to_json(const bus::FoundCommand& command) {
  return {{"service", command.full_name()},
          {"robot", command.robot},
          {"type", bus::ros_type(command.kind)},
          {"dds", command.vendor},
          {"servers", command.servers}};
}

void print(const std::vector<bus::FoundCommand>& commands, bool as_json, std::ostream& out) {
  if (as_json) {
    auto all = nlohmann::json::array();
    for (const bus::FoundCommand& command : commands) all.push_back(to_json(command));
    out << service::json_text(all) << '\n';
    return;
  }
  std::size_t width = 7;
  for (const bus::FoundCommand& command : commands) width = std::max(width, command.full_name().size());
  const auto line = [&](const std::string& name, const std::string& type, const std::string& dds,
                        const std::string& note) {
    std::string text = fmt::format("{:<{}}  {:<20}  {:<10}  {}", name, width, type, dds, note);
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  };
  line("service", "type", "DDS", "");
  for (const bus::FoundCommand& command : commands)
    line(command.full_name(), bus::ros_type(command.kind), command.vendor, note_of(command));
}

int list(const CallRequest& request, const bus::BusOptions& options, std::ostream& out, std::ostream& err) {
  const bus::CommandClient client(options);
  std::vector<bus::FoundCommand> found = find_commands(client);
  std::erase_if(found, [&](const bus::FoundCommand& command) {
    return !options.robot.empty() && !command.robot.empty() && command.robot != options.robot;
  });
  if (request.json || !found.empty()) print(found, request.json, out);
  if (!found.empty()) return service::kOk;
  err << fmt::format("rtd call: no running program offers a command in domain {}{}\n", options.domain,
                     bus::other_domains_hint(options.domain));
  return service::kRunFailed;
}

int call(const CallRequest& request, const bus::BusOptions& options, std::ostream& out, std::ostream& err) {
  bus::CommandClient client(options);
  const auto timeout_ms = static_cast<int>(request.timeout_s * 1000);
  const bus::CommandAnswer answer = client.call(request.service, request.argument, timeout_ms);
  if (request.json) {
    out << service::json_text(nlohmann::json{{"success", answer.success}, {"message", answer.message}}) << '\n';
  } else if (answer.success) {
    out << (answer.message.empty() ? "done" : io::printable(answer.message)) << '\n';
  } else {
    err << "rtd call: " << request.service << " failed: " << io::printable(answer.message) << '\n';
  }
  return answer.success ? service::kOk : service::kRunFailed;
}

/// An error of a call is exit code 1, but for a wrong argument.
int call_or_report(const CallRequest& request, const bus::BusOptions& options, std::ostream& out, std::ostream& err) {
  try {
    return call(request, options, out, err);
  } catch (const bus::CommandError& error) {
    if (error.cause() == Cause::kWrongArgument) throw;
    err << "rtd call: " << io::printable(error.what()) << '\n';
    return service::kRunFailed;
  }
}

}  // namespace

void add_call_options(CLI::App& app, CallRequest& request) {
  constexpr double kMaxSeconds = 1e6;
  auto* const name =
      app.add_option("SERVICE", request.service, "Command by its ROS name: /slam/reset, /anna/slam/reset");
  app.add_option("ARGUMENT", request.argument, "true or false of a switch, or the text that the command takes");
  app.add_option("--timeout", request.timeout_s, "Wait this long for the answer, s")
      ->check(CLI::Range(0.1, kMaxSeconds))
      ->capture_default_str();
  app.add_flag("--list", request.list, "Show the commands of all running programs")->excludes(name);
  service::add_bus_options(app, request.bus);
  app.add_flag("--json", request.json, "Print JSON instead of text");
  app.footer(
      "/slam/save_map, /slam/load_map and /recorder/start take the name of a file, not a path: its folder is that of\n"
      "--maps-dir or --recordings-dir of the service (docs/topics.md#commands).\n"
      "Exit code: 0 done; 1 the answer says that it failed, or there is none; 2 wrong arguments");
}

int run_call(const CallRequest& request, std::ostream& out, std::ostream& err) {
  return service::report_errors<service::ConfigError, bus::BusError>("rtd call", err, [&] {
    if (!request.list && request.service.empty())
      throw service::ConfigError("name a command, e.g. /slam/reset; 'rtd call --list' shows what there is");
    const bus::BusOptions options = service::load_bus_options(request.bus, "rtd-call");
    return request.list ? list(request, options, out, err) : call_or_report(request, options, out, err);
  });
}

}  // namespace rtd::topics
