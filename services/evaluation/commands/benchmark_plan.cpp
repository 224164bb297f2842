// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/benchmark_plan.hpp"

#include <fmt/format.h>

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/camera/frame_source.hpp"
#include "common/io/bytes.hpp"
#include "common/io/folder_walk.hpp"
#include "common/io/input_file.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/process/executable.hpp"
#include "common/service/config.hpp"
#include "common/service/model_locator.hpp"
#include "services/evaluation/core/ablation/ablation.hpp"
#include "services/evaluation/core/benchmark/openloris.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

constexpr const char* kProgram = "rtd_offline_run";  ///< the whole system in one process

/// The program of this build: beside this one, in PATH, or in the build folder's bench.
std::string find_program(const std::string& given) {
  if (!given.empty()) return given;
  if (std::string found = process::find_executable(kProgram); !found.empty()) return found;
  const fs::path built = fs::path(process::own_directory()) / "../bench" / kProgram;
  std::error_code ignored;
  if (fs::exists(built, ignored)) return fs::canonical(built, ignored).string();
  throw service::ConfigError(
      fmt::format("{} is not there: build it with 'cmake --build <build folder> --target {}'", kProgram, kProgram));
}

/// Another build has other bytes.
std::string build_of(const std::string& program) {
  const std::optional<std::string> bytes = io::try_read_file(program, io::kNetwork);
  if (!bytes) throw service::ConfigError("--program " + program + " cannot be read");
  return fmt::format("{:08x}-{}", io::crc32(io::bytes_of(*bytes)), bytes->size());
}

/// The network's file; empty: no detector.
std::string model_of(const BenchmarkOptions& options) {
  if (options.detector == "off") return "";
  return service::find_model("", service::process_environment()).path;
}

void choose_modes(const BenchmarkOptions& options, BenchmarkPlan& plan) {
  const bool detector = !plan.model.empty();
  const AblationPlan modes = plan_ablation({options.modes, {"none"}, detector}, msg::filter_mode_names(), {});
  for (const Variant& variant : modes.variants) plan.modes.push_back(variant.mode);
  plan.notes = modes.notes;
  if (!detector) plan.notes.emplace_back("no detector: mode rtd has geometry only");
}

fs::path detections_folder(const BenchmarkPlan& plan) {
  return plan.out_dir / "detections" / plan.build;
}

/// With --frames, the runs see different images.
fs::path detections_file(const BenchmarkOptions& options, const BenchmarkPlan& plan, const PlannedRun& planned) {
  const std::string run = options.frames > 0 ? fmt::format(".{}.{}", options.frames, planned.run) : "";
  return detections_folder(plan) /
         fmt::format("{}{}.{}", planned.input->sequence.name, run, fs::path(plan.model).stem().string());
}

/// Of OpenLORIS it has links to the images, all of which find_sequences() has found below the sequence.
std::string source_of(const BenchmarkPlan& plan, const fs::path& folder) {
  return "tum:" + folder.string() + (plan.dataset == Dataset::kOpenloris ? "?outside=1" : "");
}

}  // namespace

BenchmarkPlan plan_benchmark(const BenchmarkOptions& options) {
  BenchmarkPlan plan;
  plan.dataset = find_dataset(options.dataset)->dataset;
  plan.out_dir = options.out_dir.empty() ? "rtd_benchmark_" + options.dataset : options.out_dir;
  plan.program = find_program(options.program);
  plan.build = build_of(plan.program);
  plan.model = model_of(options);
  choose_modes(options, plan);
  return plan;
}

void prepare_inputs(const BenchmarkOptions& options, BenchmarkPlan& plan) {
  FoundSequences found = find_sequences(plan.dataset, options.folders);
  plan.left_out = std::move(found.left_out);
  for (const Sequence& sequence : found.sequences) {
    fs::path folder = sequence.folder;
    try {
      if (plan.dataset == Dataset::kOpenloris) {
        folder = fs::absolute(plan.out_dir) / "sequences" / sequence.name;
        prepare_openloris(sequence.folder, folder);
      }
      plan.inputs.push_back({sequence, source_of(plan, folder)});
    } catch (const camera::SourceError& error) {
      plan.left_out.push_back({sequence.folder.string(), error.what()});
    }
  }
}

std::vector<PlannedRun> missing_runs(const BenchmarkOptions& options, const BenchmarkPlan& plan,
                                     const Benchmark& benchmark) {
  std::vector<PlannedRun> planned;
  for (int run = 0; run < options.runs; ++run) {
    for (const BenchmarkInput& input : plan.inputs) {
      for (const std::string& mode : plan.modes) {
        if (find_run(benchmark, input.sequence.folder.string(), mode, run) == nullptr)
          planned.push_back({&input, mode, run});
      }
    }
  }
  return planned;
}

void prepare_detections(const BenchmarkPlan& plan) {
  const fs::path folder = detections_folder(plan);
  fs::create_directories(folder);
  for (const fs::path& file : io::FolderWalk().paths(folder)) {
    const std::optional<std::string> text = io::try_read_file(file, io::kResults);
    std::error_code ignored;
    if (text && !nlohmann::json::accept(*text)) fs::remove(file, ignored);
  }
}

ProgramTask task_of(const BenchmarkOptions& options, const BenchmarkPlan& plan, const PlannedRun& planned) {
  const Perturbation perturbation = perturbation_of(planned.run);
  ProgramTask task{{plan.program, "--source", planned.input->source, "--mode", planned.mode, "--first-frame",
                    std::to_string(perturbation.first_frame), "--set",
                    fmt::format("filter.orb.feature_count={}", perturbation.feature_count)},
                   ""};
  const auto add = [&](std::initializer_list<std::string> words) { task.command.insert(task.command.end(), words); };
  if (msg::find_filter_mode(planned.mode)->boxes != msg::BoxUse::kNone && !plan.model.empty()) {
    const fs::path file = detections_file(options, plan, planned);
    std::error_code ignored;
    if (!fs::exists(file, ignored)) task.first_of = file.string();
    add({"--detector", "real", "--detector-model", plan.model, "--detections", file.string(), "--detector-seed",
         std::to_string(planned.run), "--detector-jitter", planned.run == 0 ? "0" : "0.03"});
  } else {
    add({"--detector", "off"});
  }
  if (options.frames > 0) add({"--frames", std::to_string(options.frames)});
  for (const std::string& assignment : options.set) add({"--set", assignment});
  add({"--json"});
  return task;
}

}  // namespace rtd::eval
