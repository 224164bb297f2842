// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/variant_run.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/launcher/process/executable.hpp"
#include "services/launcher/run/run_command.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
namespace {

constexpr char kTaskFile[] = "variant.json";

/// What a run depends on: a result is kept only when nothing of it has changed.
nlohmann::json settings_of(const AblateOptions& options, const VariantTask& task) {
  return {{"version", RTD_VERSION},       {"source", task.source},
          {"mode", task.variant.mode},    {"settings", task.variant.settings},
          {"set", options.overrides},     {"config", options.config_file},
          {"pace", options.pace},         {"frames", options.frames},
          {"detector", options.detector}, {"model", options.model}};
}

RunOptions run_options(const AblateOptions& options, const VariantTask& task, const fs::path& folder) {
  RunOptions run;
  run.source = task.source;
  run.pace = options.pace;
  run.filter_mode = task.variant.mode;
  run.bus = options.bus;
  run.config_file = options.config_file;
  run.overrides = options.overrides;
  run.overrides.insert(run.overrides.end(), task.variant.settings.begin(), task.variant.settings.end());
  run.detector = options.detector;
  run.model = options.model;
  run.out_dir = folder.string();
  run.quiet = true;
  run.frames = options.frames;
  return run;
}

std::optional<Measurement> kept_measurement(const fs::path& folder, const nlohmann::json& settings) {
  std::ifstream file(folder / kTaskFile);
  const nlohmann::json before = nlohmann::json::parse(file, nullptr, false);
  if (!before.is_object() || before.value("settings", nlohmann::json()) != settings) return std::nullopt;
  std::optional<Measurement> measurement = read_measurement(folder);
  if (measurement) measurement->duration_s = before.value("duration_s", 0.0);
  return measurement;
}

std::string why_failed(const RunResult& result) {
  return result.record.events.empty() ? "exit code " + std::to_string(result.code) : result.record.events.back();
}

Measurement named(Measurement m, const VariantTask& task) {
  m.source = task.source_name;
  m.variant = task.variant.name;
  m.run = task.run;
  return m;
}

}  // namespace

std::string printed_config(const std::string& service) {
  const std::string executable = find_executable("rtd-" + service);
  if (executable.empty()) throw service::ConfigError("rtd-" + service + " is neither beside rtd nor in PATH");
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
  fs::remove(folder / kTaskFile, ignored);
  const std::int64_t start_ns = service::monotonic_ns();
  const RunResult result = run(run_options(options, task, folder));
  if (result.code == service::kInterrupted) return {{}, true, false};
  if (result.code == service::kUsageOrConfig)
    throw service::ConfigError("'" + task.variant.name + "' on " + task.source +
                               " could not be started (reason above)");
  const double duration_s = static_cast<double>(service::monotonic_ns() - start_ns) * 1e-9;
  Measurement measurement = named(read_measurement(folder).value_or(Measurement{}), task);
  measurement.duration_s = duration_s;
  if (result.code != service::kOk) {
    measurement.failure = why_failed(result);
  } else {  // only what is whole may be kept
    std::ofstream(folder / kTaskFile) << nlohmann::json{{"settings", settings}, {"duration_s", duration_s}}.dump(2);
  }
  return {measurement, false, false};
}

}  // namespace rtd::launcher
