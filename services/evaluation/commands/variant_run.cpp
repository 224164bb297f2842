// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/evaluation/commands/ablate_command.hpp"
#include "services/launcher/process/executable.hpp"
#include "services/launcher/process/posix_process_host.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

constexpr char kTaskFile[] = "variant.json";

std::string require_executable(const std::string& name) {
  std::string path = launcher::find_executable(name);
  if (path.empty()) throw service::ConfigError(launcher::missing_executable(name));
  return path;
}

/// What a run depends on: a result is kept only when none of it has changed.
nlohmann::json settings_of(const AblateOptions& options, const VariantTask& task) {
  return {{"version", RTD_VERSION},       {"source", task.source},
          {"mode", task.variant.mode},    {"settings", task.variant.settings},
          {"set", options.overrides},     {"config", options.config_file},
          {"pace", options.pace},         {"frames", options.frames},
          {"detector", options.detector}, {"model", options.model}};
}

std::vector<std::string> run_command(const AblateOptions& options, const VariantTask& task, const fs::path& folder) {
  std::vector<std::string> command = {require_executable("rtd"), "run"};
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) command.insert(command.end(), {option, value});
  };
  add("--source", task.source);
  add("--out", folder.string());
  add("--pace", options.pace);
  add("--filter", task.variant.mode);
  add("--config", options.config_file);
  add("--detector", options.detector);
  add("--model", options.model);
  if (options.frames > 0) add("--frames", std::to_string(options.frames));
  for (const std::string& assignment : options.overrides) add("--set", assignment);
  for (const std::string& assignment : task.variant.settings) add("--set", assignment);
  const std::vector<std::string> bus = service::to_command_line(options.bus);
  command.insert(command.end(), bus.begin(), bus.end());
  command.emplace_back("--quiet");
  return command;
}

/// The exit code of `rtd run`; Ctrl-C is passed on to it.
int run_in_folder(const AblateOptions& options, const VariantTask& task, const fs::path& folder) {
  service::InterruptSignals signals;
  const launcher::ProcessExit exit =
      launcher::run_to_end({"rtd run", run_command(options, task, folder)}, signals,
                           [](const std::string&, const std::string& line) { std::cerr << line << std::endl; });
  return exit.signal != 0 ? static_cast<int>(service::kRunFailed) : exit.code;
}

std::optional<Measurement> kept_measurement(const fs::path& folder, const nlohmann::json& settings) {
  std::ifstream file(folder / kTaskFile);
  const nlohmann::json before = nlohmann::json::parse(file, nullptr, false);
  if (!before.is_object() || before.value("settings", nlohmann::json()) != settings) return std::nullopt;
  std::optional<Measurement> measurement = read_measurement(folder);
  if (measurement) measurement->duration_s = before.value("duration_s", 0.0);
  return measurement;
}

Measurement named(Measurement m, const VariantTask& task) {
  m.source = task.source_name;
  m.variant = task.variant.name;
  m.run = task.run;
  return m;
}

}  // namespace

std::string printed_config(const std::string& service) {
  const std::string executable = require_executable("rtd-" + service);
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("'" + executable + "' --print-config").c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> part{};
  while (pipe != nullptr && std::fgets(part.data(), static_cast<int>(part.size()), pipe.get()) != nullptr)
    text += part.data();
  if (text.empty()) throw service::ConfigError(executable + " --print-config printed nothing");
  return text;
}

VariantRun run_variant(const AblateOptions& options, const VariantTask& task) {
  const fs::path folder =
      fs::path(options.out_dir) / task.source_name / task.variant.folder() / std::to_string(task.run);
  const nlohmann::json settings = settings_of(options, task);
  if (options.resume) {
    if (const auto kept = kept_measurement(folder, settings)) return {named(*kept, task), false, true};
  }
  std::error_code ignored;
  for (const char* stale : {kTaskFile, "report.json"}) fs::remove(folder / stale, ignored);
  const std::int64_t start_ns = service::monotonic_ns();
  const int code = run_in_folder(options, task, folder);
  if (code == service::kInterrupted) return {{}, true, false};
  if (code == service::kUsageOrConfig)
    throw service::ConfigError("'" + task.variant.name + "' on " + task.source +
                               " could not be started (reason above)");
  const double duration_s = static_cast<double>(service::monotonic_ns() - start_ns) * 1e-9;
  Measurement measurement = named(read_measurement(folder).value_or(Measurement{}), task);
  measurement.duration_s = duration_s;
  if (code != service::kOk) {
    measurement.failure = last_event(folder).value_or("exit code " + std::to_string(code));
  } else {  // only a complete run may be kept
    std::ofstream(folder / kTaskFile) << nlohmann::json{{"settings", settings}, {"duration_s", duration_s}}.dump(2);
  }
  return {measurement, false, false};
}

}  // namespace rtd::eval
