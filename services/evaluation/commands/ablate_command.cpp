// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/ablate_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/camera/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/input_file.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/process/executable.hpp"
#include "common/process/out_folder.hpp"
#include "common/process/posix_process_host.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/model_table.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/standard_streams.hpp"
#include "services/evaluation/commands/guarded.hpp"
#include "services/evaluation/core/ablation/ablation.hpp"
#include "services/evaluation/core/report/report.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

/// Called after every run, so that no measurement is lost.
void write_results(const Ablation& ablation, const fs::path& out_dir) {
  write_file(out_dir / "ablation.json", service::json_text(ablation_json(ablation)) + "\n");
  write_file(out_dir / "ablation.md", ablation_markdown(ablation));
  write_file(out_dir / "ablation.html", ablation_html(ablation));
}

std::string require_executable(const std::string& name) {
  std::string path = process::find_executable(name);
  if (path.empty()) throw service::ConfigError(process::missing_executable(name));
  return path;
}

/// What `rtd-<service> --print-config` prints.
std::string printed_config(const std::string& service) {
  const std::string executable = require_executable("rtd-" + service);
  std::string text = process::output_of(executable, {"--print-config"});
  if (text.empty()) throw service::ConfigError(executable + " --print-config printed nothing");
  return text;
}

std::vector<Technique> known_techniques() {
  std::vector<Technique> techniques;
  for (const char* service : {"filter", "slam"}) {
    const std::vector<Technique> found = read_techniques(printed_config(service), service);
    techniques.insert(techniques.end(), found.begin(), found.end());
  }
  return techniques;
}

/// An ablation compares errors, so the source needs ground truth.
void check_source(const std::string& uri, const AblateOptions& options, std::vector<std::string>& notes) {
  const auto source = camera::make_source(uri);
  const bool synthetic = run_record::is_synthetic(uri);
  if (source->info().frames == 0 && options.frames == 0)
    throw service::ConfigError("--source " + uri + " is endless: limit it with --frames");
  if (!synthetic && source->groundtruth().empty())
    throw service::ConfigError("--source " + uri +
                               " has no ground truth: there is no error to compare (groundtruth.txt)");
  if (!run_record::has_true_masks(uri))
    notes.push_back(uri + " has no mask/: precision and recall of removed points are unknown");
}

bool has_detector(const AblateOptions& options) {
  if (options.detector == "off") return false;
  const service::ModelSearch model = service::find_model(options.model, service::process_environment());
  if (!model && !options.model.empty()) throw service::ConfigError(model.message);
  return static_cast<bool>(model);
}

Ablation prepare(const AblateOptions& options) {
  Ablation ablation;
  ablation.version = RTD_VERSION;
  ablation.pace = options.pace;
  ablation.runs = options.runs;
  ablation.plan = plan_ablation({options.modes, options.without, has_detector(options)}, msg::filter_mode_names(),
                                known_techniques());
  for (const std::string& source : options.sources) {
    ablation.sources.push_back(camera::complete_uri(source));
    check_source(ablation.sources.back(), options, ablation.notes);
  }
  ablation.source_names = source_names(ablation.sources);
  if (options.runs > 1 && options.pace == "lockstep")
    ablation.notes.emplace_back(
        "lockstep gives the same bytes each time: more than one run is a check, not a statistic");
  return ablation;
}

/// One run of the experiment.
struct VariantTask {
  std::string source, source_name;
  Variant variant;
  int run = 1;
};
struct VariantRun {
  Measurement measurement;
  bool interrupted = false;
  bool reused = false;  ///< measured by an earlier ablation
};

constexpr char kTaskFile[] = "variant.json";

/// What a run depends on: a result is kept only when none of it has changed.
nlohmann::json settings_of(const AblateOptions& options, const VariantTask& task) {
  return {{"version", RTD_VERSION},
          {"source", task.source},
          {"mode", task.variant.mode},
          {"settings", task.variant.settings},
          {"set", options.config.overrides},
          {"config", options.config.file},
          {"pace", options.pace},
          {"frames", options.frames},
          {"detector", options.detector},
          {"model", options.model}};
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
  add("--detector", options.detector);
  add("--model", options.model);
  if (options.frames > 0) add("--frames", std::to_string(options.frames));
  const std::vector<std::string> sources = service::to_command_line(options.config);
  command.insert(command.end(), sources.begin(), sources.end());
  for (const std::string& assignment : task.variant.settings) add("--set", assignment);
  command.emplace_back("--quiet");
  return command;
}

/// The exit code of `rtd run`; Ctrl-C is passed on to it.
int run_in_folder(const AblateOptions& options, const VariantTask& task, const fs::path& folder) {
  service::InterruptSignals signals;
  const process::ProcessExit exit =
      process::run_to_end({"rtd run", run_command(options, task, folder)}, signals,
                          [](const std::string&, const std::string& line) { std::cerr << line << std::endl; });
  return exit.signal != 0 ? static_cast<int>(service::kRunFailed) : exit.code;
}

std::optional<Measurement> kept_measurement(const fs::path& folder, const nlohmann::json& settings) {
  const std::string task = io::try_read_file(folder / kTaskFile, io::kResults).value_or("");
  const nlohmann::json before = nlohmann::json::parse(task, nullptr, false);
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

/// Runs it in OUT/<source>/<variant>/<run>. With --resume, an earlier result of the same settings is taken instead. A
/// run that fails is a measurement with a reason.
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
    io::write_file(folder / kTaskFile,
                   service::json_text(nlohmann::json{{"settings", settings}, {"duration_s", duration_s}}));
  }
  return {measurement, false, false};
}

std::string result_text(const Measurement& m) {
  if (!m.failure.empty()) return "failed: " + m.failure;
  if (m.ate_poses == 0) return fmt::format("no ATE, coverage {:.3f} of {:.0f} frames", m.coverage, m.frames);
  return fmt::format("ATE {:.4f} m over {:.0f} poses, coverage {:.3f} of {:.0f} frames", m.ate_m, m.ate_poses,
                     m.coverage, m.frames);
}

/// Prints what is run, as "[ 3/24] walk_xyz, without belief: ATE 0.0038 m over 210 poses, coverage 1.000 of 210
/// frames (14 s; 5 min left)".
class Progress {
 public:
  explicit Progress(const Ablation& ablation)
      : ablation_(ablation),
        total_(ablation.sources.size() * ablation.plan.variants.size() * static_cast<std::size_t>(ablation.runs)) {}

  void begin(const std::string& source, const Variant& variant, int run) const {
    std::cerr << fmt::format("[{:>2}/{}] {}, {}{}: ", ablation_.measurements.size() + 1, total_, source, variant.name,
                             ablation_.runs > 1 ? fmt::format(", run {}", run) : "")
              << std::flush;
  }
  void end(const Measurement& m, bool reused) const {
    const double left_s = remaining_s(ablation_).value_or(0);
    std::cerr << result_text(m)
              << (reused ? " (kept)\n"
                         : fmt::format(
                               " ({:.0f} s; {} left)\n", m.duration_s,
                               left_s < 90 ? fmt::format("{:.0f} s", left_s) : fmt::format("{:.0f} min", left_s / 60)));
  }

 private:
  const Ablation& ablation_;
  std::size_t total_;
};

/// Returns false when interrupted.
bool measure_all(const AblateOptions& options, Ablation& ablation) {
  const Progress progress(ablation);
  for (std::size_t i = 0; i < ablation.sources.size(); ++i) {
    for (const Variant& variant : ablation.plan.variants) {
      for (int run = 1; run <= options.runs; ++run) {
        progress.begin(ablation.source_names[i], variant, run);
        const VariantRun result = run_variant(options, {ablation.sources[i], ablation.source_names[i], variant, run});
        if (result.interrupted) return false;
        ablation.measurements.push_back(result.measurement);
        progress.end(result.measurement, result.reused);
        write_results(ablation, options.out_dir);
      }
    }
  }
  ablation.complete = true;
  return true;
}

service::ExitCode run_ablation(const AblateOptions& options) {
  Ablation ablation = prepare(options);
  const process::FolderLock folder = process::take_out_folder(options.out_dir);
  const bool finished = measure_all(options, ablation);
  write_results(ablation, options.out_dir);
  if (options.json) {
    std::cout << service::json_text(ablation_json(ablation)) << '\n';
  } else {
    std::cout << ablation_text(ablation) << "  report: " << options.out_dir << "/ablation.html\n";
  }
  if (!finished) {
    std::cerr << "\nrtd ablate: interrupted; continue with --resume\n";
    return service::kInterrupted;
  }
  for (const Measurement& m : ablation.measurements) {
    if (!m.failure.empty()) return service::kRunFailed;
  }
  return service::kOk;
}

}  // namespace

void add_ablate_command(CLI::App& app, AblateOptions& options) {
  CLI::App* command = app.add_subcommand("ablate", "Every filter mode, and rtd without each technique, compared");
  command->add_option("--source", options.sources, camera::stored_source_forms() + ", with ground truth (repeatable)")
      ->required();
  command->add_option("--runs", options.runs, "Runs of each")->check(CLI::Range(1, 1000))->capture_default_str();
  command->add_option("--pace", options.pace, "realtime, asap or lockstep")
      ->check(CLI::IsMember({"realtime", "asap", "lockstep"}))
      ->capture_default_str();
  command->add_option("--modes", options.modes, "Only these modes")->delimiter(',');
  command->add_option("--without", options.without, "Only these techniques are switched off; none: modes only")
      ->delimiter(',');
  command->add_option("--out", options.out_dir, "Folder for all runs and ablation.html")->capture_default_str();
  command->add_option("--frames", options.frames, "End each run after so many frames");
  service::add_source_options(*command, options.config);
  service::add_bus_options(*command, options.config);
  command->add_option("--detector", options.detector, "auto: when weights are found; off: modes that need none")
      ->check(CLI::IsMember({"auto", "off"}))
      ->capture_default_str();
  command->add_option("--model", options.model,
                      "The network: " + service::known_model_names() + ", or an ONNX file; default: as 'rtd run'");
  command->add_flag("--json", options.json, "JSON on standard output");
  command->add_flag("--resume", options.resume, "Keep finished runs of the same settings in the folder");
}

int run_ablate(const AblateOptions& options) {
  service::outlive_readers();
  return guarded("rtd ablate", std::cerr, [&] { return run_ablation(options); });
}

}  // namespace rtd::eval
