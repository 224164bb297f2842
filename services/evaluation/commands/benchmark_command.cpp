// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/benchmark_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/io/atomic_file.hpp"
#include "common/process/out_folder.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/json_text.hpp"
#include "common/service/standard_streams.hpp"
#include "services/evaluation/commands/benchmark_plan.hpp"
#include "services/evaluation/commands/guarded.hpp"
#include "services/evaluation/core/benchmark/benchmark.hpp"
#include "services/evaluation/core/benchmark/dataset.hpp"
#include "services/evaluation/core/report/report.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

constexpr const char* kResults = "benchmark.json";
constexpr const char* kPage = "benchmark.html";

/// The runs of an earlier call that count here; else its file is kept beside the new one.
void take_up(const fs::path& file, Benchmark& benchmark) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return;
  Benchmark earlier = read_benchmark(file.string());
  if (earlier.settings == benchmark.settings) {
    std::erase_if(earlier.runs, [](const BenchmarkRun& run) { return !run.failure.empty(); });
    benchmark.runs = std::move(earlier.runs);
    return;
  }
  const fs::path previous = file.parent_path() / "benchmark.previous.json";
  fs::rename(file, previous);
  std::cerr << "rtd benchmark: " << file.string() << " is of another build or of other options: it is now "
            << previous.string() << '\n';
}

/// The object that the program printed at the end; long lines come in pieces.
std::string printed_object(const std::vector<std::string>& lines) {
  const auto begins = [](const std::string& line) { return line.starts_with('{'); };
  const auto last = std::find_if(lines.rbegin(), lines.rend(), begins);
  std::string object;
  if (last == lines.rend()) return object;
  for (auto line = std::prev(last.base()); line != lines.end(); ++line) object += *line;
  return object;
}

BenchmarkRun result_of(const PlannedRun& planned, const ProgramResult& result) {
  const Sequence& sequence = planned.input->sequence;
  BenchmarkRun run{sequence.name, sequence.folder.string(), planned.mode, planned.run, result.duration_s, "", {}};
  const nlohmann::json printed = nlohmann::json::parse(printed_object(result.lines), nullptr, false);
  if (!result.exit.clean() || !printed.is_object()) {
    run.failure = describe(result.exit) + ": " + (result.lines.empty() ? "it printed nothing" : result.lines.back());
  } else {
    run.figures = figures_of(printed);
  }
  return run;
}

std::string duration_text(double s) {
  return s < 90     ? fmt::format("{:.0f} s", s)
         : s < 5400 ? fmt::format("{:.0f} min", s / 60)
                    : fmt::format("{:.1f} h", s / 3600);
}

/// Prints "[ 3/24] fr3_walking_xyz, rtd, run 2: ATE 0.0153 m, coverage 1.000 (74 s; 31 min left)".
class BenchmarkProgress {
 public:
  BenchmarkProgress(const BenchmarkOptions& options, const std::vector<PlannedRun>& planned) : options_(options) {
    for (const PlannedRun& one : planned) left_frames_ += frames_of(one);
    total_ = planned.size();
  }

  void end(const PlannedRun& planned, const BenchmarkRun& run) {
    ++done_;
    left_frames_ -= frames_of(planned);
    done_frames_ += frames_of(planned);
    spent_s_ += run.duration_s;
    const double left_s = spent_s_ / done_frames_ * left_frames_ / options_.jobs;
    std::cerr << fmt::format("[{:>2}/{}] {}, {}, run {}: {} ({}; {} left)\n", done_, total_, run.sequence, run.mode,
                             run.run + 1, text(run), duration_text(run.duration_s), duration_text(left_s));
  }

 private:
  double frames_of(const PlannedRun& planned) const {
    const auto all = static_cast<double>(std::max<std::size_t>(1, planned.input->sequence.frames));
    return options_.frames == 0 ? all : std::min(all, static_cast<double>(options_.frames));
  }
  static std::string text(const BenchmarkRun& run) {
    if (!run.failure.empty()) return "failed: " + run.failure;
    const auto figure = [&](const char* name, const char* format) {
      const auto found = run.figures.find(name);
      return number_text(found == run.figures.end() ? std::nan("") : found->second, format);
    };
    return fmt::format("ATE {} m, coverage {}", figure("ate_m", "{:.4f}"), figure("coverage", "{:.3f}"));
  }

  const BenchmarkOptions& options_;
  std::size_t total_ = 0, done_ = 0;
  double left_frames_ = 0, done_frames_ = 0, spent_s_ = 0;
};

/// Called after every run, so that none is lost.
void write_results(const BenchmarkPlan& plan, const Benchmark& benchmark, const Benchmark* before) {
  io::write_file(plan.out_dir / kResults, service::json_text(benchmark_json(benchmark)) + "\n");
  write_file(plan.out_dir / kPage, benchmark_html(benchmark, before));
}

/// Returns false when interrupted.
bool run_missing(const BenchmarkOptions& options, const BenchmarkPlan& plan, Benchmark& benchmark,
                 const Benchmark* before) {
  service::InterruptSignals signals;
  const std::vector<PlannedRun> planned = missing_runs(options, plan, benchmark);
  std::cerr << fmt::format("rtd benchmark: sequences: {}, runs to do: {}, kept from earlier calls: {}\n",
                           plan.inputs.size(), planned.size(), benchmark.runs.size());
  std::vector<ProgramTask> tasks;
  for (const PlannedRun& one : planned) tasks.push_back(task_of(options, plan, one));
  BenchmarkProgress progress(options, planned);
  return run_programs(tasks, options.jobs, signals, [&](const ProgramResult& result) {
    const PlannedRun& one = planned[result.task];
    benchmark.runs.push_back(result_of(one, result));
    progress.end(one, benchmark.runs.back());
    write_results(plan, benchmark, before);
  });
}

std::optional<Benchmark> read_other(const BenchmarkOptions& options) {
  if (options.compare.empty()) return std::nullopt;
  Benchmark other = read_benchmark(options.compare);
  if (other.settings.dataset != options.dataset)
    throw service::ConfigError("--compare " + options.compare + " is of dataset " + other.settings.dataset +
                               ": give one of dataset " + options.dataset);
  return other;
}

service::ExitCode exit_code(const Benchmark& benchmark) {
  for (const BenchmarkRun& run : benchmark.runs) {
    if (!run.failure.empty()) return service::kRunFailed;
  }
  return benchmark.left_out.empty() ? service::kOk : service::kPartialLoss;
}

/// Sequences that are left out are named at once.
void name_left_out(const BenchmarkPlan& plan) {
  for (const LeftOut& one : plan.left_out)
    std::cerr << "rtd benchmark: " << one.folder << " is left out: " << one.reason << '\n';
}

Benchmark begin(const BenchmarkOptions& options, const BenchmarkPlan& plan) {
  const std::string detector = plan.model.empty() ? "off" : fs::path(plan.model).filename().string();
  Benchmark benchmark;
  benchmark.settings = {RTD_VERSION, plan.build, options.dataset, detector, options.frames, options.set};
  benchmark.jobs = options.jobs;
  benchmark.left_out = plan.left_out;
  benchmark.notes = plan.notes;
  take_up(plan.out_dir / kResults, benchmark);
  return benchmark;
}

void print_results(const BenchmarkOptions& options, const BenchmarkPlan& plan, const Benchmark& benchmark,
                   const Benchmark* before) {
  if (options.json) {
    std::cout << service::json_text(benchmark_json(benchmark)) << '\n';
  } else {
    std::cout << benchmark_text(benchmark, before) << "  page: " << (plan.out_dir / kPage).string() << '\n';
  }
  if (!benchmark.complete) std::cerr << "\nrtd benchmark: interrupted; the same command continues\n";
}

service::ExitCode measure(const BenchmarkOptions& options) {
  BenchmarkPlan plan = plan_benchmark(options);
  const std::optional<Benchmark> other = read_other(options);
  const process::FolderLock lock = process::take_out_folder(plan.out_dir.string());
  prepare_inputs(options, plan);
  name_left_out(plan);
  if (plan.inputs.empty())
    throw service::ConfigError(fmt::format("no sequence of {} to run in these folders; its sequences are named {}",
                                           named(plan.dataset).title, named(plan.dataset).folder_form));
  Benchmark benchmark = begin(options, plan);
  prepare_detections(plan);
  const Benchmark* const before = other ? &*other : nullptr;
  benchmark.complete = run_missing(options, plan, benchmark, before);
  write_results(plan, benchmark, before);
  print_results(options, plan, benchmark, before);
  return benchmark.complete ? exit_code(benchmark) : service::kInterrupted;
}

std::vector<std::string> dataset_names() {
  std::vector<std::string> names;
  for (const NamedDataset& dataset : kDatasets) names.emplace_back(dataset.name);
  return names;
}

}  // namespace

void add_benchmark_command(CLI::App& app, BenchmarkOptions& options) {
  CLI::App* command = app.add_subcommand("benchmark", "Every filter mode on public datasets, beside published figures");
  command->add_option("dataset", options.dataset, "tum, bonn or openloris")
      ->required()
      ->check(CLI::IsMember(dataset_names()));
  command->add_option("folders", options.folders, "Searched for sequences by the names of their folders")->required();
  command->add_option("--runs", options.runs, "Runs of each, with other first frames, feature counts and boxes")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--modes", options.modes, "Only these modes")->delimiter(',');
  command->add_option("--out", options.out_dir, "Folder for benchmark.html and .json (default: rtd_benchmark_DATASET)");
  command->add_option("--compare", options.compare, "benchmark.json of another build: shows what has changed");
  command->add_option("--jobs", options.jobs, "Runs beside each other; more make the ms larger")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--frames", options.frames, "End each run after so many frames");
  command->add_option("--set", options.set, "filter.KEY=VALUE or slam.KEY=VALUE (repeatable)");
  command->add_option("--detector", options.detector, "auto: when weights are found; off: modes that need none")
      ->check(CLI::IsMember({"auto", "off"}))
      ->capture_default_str();
  command->add_option("--program", options.program, "rtd_offline_run of another build")->check(CLI::ExistingFile);
  command->add_flag("--json", options.json, "JSON on standard output");
}

int run_benchmark(const BenchmarkOptions& options) {
  service::outlive_readers();
  return guarded("rtd benchmark", std::cerr, [&] { return measure(options); });
}

}  // namespace rtd::eval
