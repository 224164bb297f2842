// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/experiment_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>

#include "common/camera/source_schemes.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/bytes.hpp"
#include "common/io/input_file.hpp"
#include "common/process/out_folder.hpp"
#include "common/process/posix_process_host.hpp"
#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/standard_streams.hpp"
#include "services/evaluation/commands/experiment_plan.hpp"
#include "services/evaluation/commands/guarded.hpp"

namespace rtd::eval {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{50};

class Runner {
 public:
  Runner(const std::vector<ProgramTask>& tasks, int jobs, const std::function<void(const ProgramResult&)>& on_done)
      : tasks_(tasks), on_done_(on_done), places_(static_cast<std::size_t>(jobs)) {}

  bool run(service::InterruptSignals& signals) {
    while (fill_places()) {
      host_.wait(kPollPeriod, signals.fd());
      if (signals.take() > 0) {
        end_all();
        return false;
      }
      collect();
    }
    return true;
  }

 private:
  struct Running {
    std::size_t task;
    process::ProcessId process;
    std::int64_t start_ns;
  };

  /// Returns false when nothing runs any more.
  bool fill_places() {
    bool any = false;
    for (std::size_t place = 0; place < places_.size(); ++place) {
      if (!places_[place] && next_ < tasks_.size()) {
        const process::ProcessId process = host_.start({std::to_string(next_), tasks_[next_](static_cast<int>(place))});
        places_[place] = {next_++, process, service::monotonic_ns()};
      }
      any = any || places_[place];
    }
    return any;
  }

  void collect() {
    for (std::optional<Running>& one : places_) {
      const auto exit = one ? host_.poll_exit(one->process) : std::nullopt;
      if (!exit) continue;
      const double duration_s = static_cast<double>(service::monotonic_ns() - one->start_ns) * 1e-9;
      const ProgramResult result{one->task, *exit, duration_s, lines_[std::to_string(one->task)]};
      one.reset();
      on_done_(result);
    }
  }

  void end_all() {
    for (const auto& one : places_) {
      if (one) host_.terminate(one->process);
    }
    for (const auto& one : places_) {
      while (one && !host_.poll_exit(one->process)) host_.wait(kPollPeriod);
    }
  }

  const std::vector<ProgramTask>& tasks_;
  const std::function<void(const ProgramResult&)>& on_done_;
  std::vector<std::optional<Running>> places_;
  std::size_t next_ = 0;
  std::map<std::string, std::string> lines_;  ///< the last ones
  process::PosixProcessHost host_{
      [this](const std::string& name, const std::string& line) { std::cerr << (lines_[name] = line) << std::endl; }};
};

}  // namespace

bool run_programs(const std::vector<ProgramTask>& tasks, int jobs, service::InterruptSignals& signals,
                  const std::function<void(const ProgramResult&)>& on_done) {
  return Runner(tasks, jobs, on_done).run(signals);
}

namespace fs = std::filesystem;
namespace {

std::string command_of(const ExperimentOptions& options) {
  return options.is_benchmark() ? "rtd benchmark" : "rtd ablate";
}

/// The runs of an earlier call that count here; else its file is kept next to the new one.
void resume_from(const ExperimentOptions& options, Experiment& experiment) {
  const fs::path file = fs::path(options.out_dir) / (experiment.name + ".json");
  std::error_code ignored;
  if (!options.resume || !fs::exists(file, ignored)) return;
  Experiment earlier = read_experiment(file.string());
  if (earlier.settings == experiment.settings) {
    std::erase_if(earlier.results, [](const ExperimentRun& run) { return !run.failure.empty(); });
    experiment.results = std::move(earlier.results);
    return;
  }
  const fs::path previous = file.parent_path() / (experiment.name + ".previous.json");
  fs::rename(file, previous);
  std::cerr << command_of(options) << ": " << file.string() << " is of another build or of other options: it is now "
            << previous.string() << '\n';
}

std::string checksum(const fs::path& file) {
  return fmt::format("{:08x}", io::crc32(io::bytes_of(io::try_read_file(file, io::kPoses).value_or(""))));
}

/// Of a public dataset there are hundreds of runs: what can be made again takes no space.
void clear(const PlannedRun& planned) {
  std::error_code ignored;
  for (const char* file : {"map.rtdmap", "run.json"}) fs::remove(fs::path(planned.folder) / file, ignored);
}

ExperimentRun result_of(const PlannedRun& planned, const ProgramResult& result) {
  if (result.exit.code == service::kUsageOrConfig && result.exit.signal == 0)
    throw service::ConfigError("'" + planned.variant.name + "' on " + planned.subject.source +
                               " could not be started: " + result.last_line);
  const fs::path folder = planned.folder;
  ExperimentRun run{planned.subject.source,
                    planned.variant.name,
                    planned.run,
                    result.duration_s,
                    "",
                    read_figures(folder).value_or(Figures{}),
                    checksum(folder / "trajectory.txt")};
  if (!result.exit.clean()) run.failure = last_event(folder).value_or(describe(result.exit) + ": " + result.last_line);
  return run;
}

std::string duration_text(double s) {
  return s < 90     ? fmt::format("{:.0f} s", s)
         : s < 5400 ? fmt::format("{:.0f} min", s / 60)
                    : fmt::format("{:.1f} h", s / 3600);
}

std::string result_text(const ExperimentRun& run) {
  if (!run.failure.empty()) return "failed: " + run.failure;
  const auto figure = [&](const char* name, const char* format) {
    const auto found = run.figures.find(name);
    return found == run.figures.end() ? "-" : number_text(found->second, format);
  };
  return fmt::format("ATE {} m over {} poses, coverage {} of {} frames", figure("ate_m", "{:.4f}"),
                     figure("ate_poses", "{:.0f}"), figure("coverage", "{:.3f}"), figure("frames", "{:.0f}"));
}

/// Called after every run, so that none is lost.
void write_results(const ExperimentOptions& options, const Experiment& experiment, const Experiment* before) {
  const fs::path folder = options.out_dir;
  io::write_file(folder / (experiment.name + ".json"), service::json_text(experiment_json(experiment)) + "\n");
  io::write_file(folder / (experiment.name + ".md"), experiment_markdown(experiment, before));
  io::write_file(folder / (experiment.name + ".html"), experiment_html(experiment, before));
}

/// Prints "[ 3/24] walk_xyz, without belief: ATE 0.0038 m over 210 poses, coverage 1.000 of 210 frames (14 s; 5 min
/// left)" after each. Returns false when interrupted.
bool run_missing(const ExperimentOptions& options, Experiment& experiment, const Experiment* before) {
  service::InterruptSignals signals;
  const std::vector<PlannedRun> planned = missing_runs(options, experiment);
  std::cerr << fmt::format("{}: sources: {}, runs to do: {}, kept from earlier calls: {}\n", command_of(options),
                           experiment.subjects.size(), planned.size(), experiment.results.size());
  std::vector<ProgramTask> tasks;
  for (const PlannedRun& one : planned) {
    tasks.emplace_back([&](int place) {
      std::error_code ignored;
      fs::remove(fs::path(one.folder) / "report.json", ignored);  // of an earlier run
      return run_command(options, one, place);
    });
  }
  std::size_t done = 0;
  return run_programs(tasks, options.jobs, signals, [&](const ProgramResult& result) {
    const PlannedRun& one = planned[result.task];
    const ExperimentRun& run = experiment.results.emplace_back(result_of(one, result));
    if (options.is_benchmark()) clear(one);
    std::cerr << fmt::format("[{:>2}/{}] {}, {}{}: {} ({}; {} left)\n", ++done, planned.size(), one.subject.name,
                             run.variant, options.runs > 1 ? fmt::format(", run {}", run.run) : "", result_text(run),
                             duration_text(run.duration_s), duration_text(remaining_s(experiment).value_or(0)));
    write_results(options, experiment, before);
  });
}

std::optional<Experiment> read_other(const ExperimentOptions& options) {
  if (options.compare.empty()) return std::nullopt;
  Experiment other = read_experiment(options.compare);
  const std::string dataset = other.settings.value("dataset", "");
  if (dataset != options.dataset)
    throw service::ConfigError("--compare " + options.compare + " is of dataset '" + dataset +
                               "': give one of dataset '" + options.dataset + "'");
  return other;
}

service::ExitCode exit_code(const Experiment& experiment) {
  if (!experiment.complete) return service::kInterrupted;
  for (const ExperimentRun& run : experiment.results) {
    if (!run.failure.empty()) return service::kRunFailed;
  }
  return experiment.left_out.empty() ? service::kOk : service::kPartialLoss;
}

void print_results(const ExperimentOptions& options, const Experiment& experiment, const Experiment* before) {
  if (options.json) {
    std::cout << service::json_text(experiment_json(experiment)) << '\n';
  } else {
    std::cout << experiment_text(experiment, before) << "  page: " << options.out_dir << '/' << experiment.name
              << ".html\n";
  }
  if (!experiment.complete)
    std::cerr << '\n'
              << command_of(options) << ": interrupted; the same command"
              << (options.is_benchmark() ? "" : " with --resume") << " continues\n";
}

service::ExitCode measure(const ExperimentOptions& options) {
  const std::optional<Experiment> other = read_other(options);
  const Experiment* const before = other ? &*other : nullptr;
  const process::FolderLock lock = process::take_out_folder(options.out_dir);
  Experiment experiment = plan_experiment(options);
  for (const LeftOut& one : experiment.left_out)
    std::cerr << command_of(options) << ": " << one.folder << " is left out: " << one.reason << '\n';
  resume_from(options, experiment);
  experiment.complete = run_missing(options, experiment, before);
  write_results(options, experiment, before);
  print_results(options, experiment, before);
  return exit_code(experiment);
}

/// What both commands have.
void add_common_options(CLI::App& command, ExperimentOptions& options) {
  command.add_option("--modes", options.modes, "Only these modes")->delimiter(',');
  command.add_option("--pace", options.pace, "realtime, asap or lockstep")
      ->check(CLI::IsMember({"realtime", "asap", "lockstep"}))
      ->capture_default_str();
  command.add_option("--compare", options.compare, "Results (.json) of another build or other options to compare with");
  command
      .add_option("--jobs", options.jobs, "Runs at the same time, in their own DDS domains; more make the ms larger")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command.add_option("--frames", options.frames, "End each run after so many frames");
  command.add_option("--detector", options.detector, "auto: when weights are found; off: modes that need none")
      ->check(CLI::IsMember({"auto", "off"}))
      ->capture_default_str();
  command.add_option("--model", options.model,
                     "The network: " + service::known_model_names() + ", or an ONNX file; default: as 'rtd run'");
  command.add_flag("--json", options.json, "JSON on standard output");
  service::add_source_options(command, options.config);
  service::add_bus_options(command, options.config);
}

std::vector<std::string> dataset_names() {
  std::vector<std::string> names;
  for (const NamedDataset& dataset : kDatasets) names.emplace_back(dataset.name);
  return names;
}

}  // namespace

void add_ablate_command(CLI::App& app, ExperimentOptions& options) {
  CLI::App* command = app.add_subcommand("ablate", "Every filter mode, and rtd without each technique, compared");
  command->add_option("--source", options.sources, camera::stored_source_forms() + ", with ground truth (repeatable)")
      ->required();
  command->add_option("--without", options.without, "Only these techniques are switched off; none: modes only")
      ->delimiter(',');
  command->add_option("--runs", options.runs, "Runs of each")->check(CLI::Range(1, 1000))->capture_default_str();
  options.out_dir = "rtd_ablation";
  command->add_option("--out", options.out_dir, "Folder for all runs and ablation.html")->capture_default_str();
  command->add_flag("--resume", options.resume, "Keep finished runs of the same settings in the folder");
  add_common_options(*command, options);
}

void add_benchmark_command(CLI::App& app, ExperimentOptions& options) {
  CLI::App* command = app.add_subcommand("benchmark", "Every filter mode on public datasets");
  command->add_option("dataset", options.dataset, "tum, bonn or openloris")
      ->required()
      ->check(CLI::IsMember(dataset_names()));
  command->add_option("folders", options.folders, "Searched for sequences by the names of their folders")->required();
  options.runs = 5;
  command->add_option("--runs", options.runs, "Runs of each, with other feature counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--out", options.out_dir,
                      "Folder for all runs and benchmark.html (default: rtd_benchmark_DATASET)");
  options.resume = true;
  add_common_options(*command, options);
}

int run_experiment(ExperimentOptions options) {
  service::outlive_readers();
  if (options.out_dir.empty()) options.out_dir = "rtd_benchmark_" + options.dataset;
  return guarded(command_of(options), std::cerr, [&] { return measure(options); });
}

}  // namespace rtd::eval
