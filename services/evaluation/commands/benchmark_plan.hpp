// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/evaluation/commands/benchmark_command.hpp"
#include "services/evaluation/commands/benchmark_runner.hpp"
#include "services/evaluation/core/benchmark/benchmark.hpp"
#include "services/evaluation/core/benchmark/dataset.hpp"

namespace rtd::eval {

/// A sequence in a layout that sources read.
struct BenchmarkInput {
  Sequence sequence;
  std::string source;  ///< URI
};

/// What `rtd benchmark` knows before the first run.
struct BenchmarkPlan {
  Dataset dataset{};
  std::filesystem::path out_dir;
  std::string program;  ///< runs the whole system on a source in one process
  std::string build;    ///< identifies it
  std::string model;    ///< the network's file; empty: no detector
  std::vector<std::string> modes;
  std::vector<BenchmarkInput> inputs;
  std::vector<LeftOut> left_out;
  std::vector<std::string> notes;
};

/// Searches program, network and modes. Throws service::ConfigError.
BenchmarkPlan plan_benchmark(const BenchmarkOptions& options);

/// Finds the sequences and prepares those that are in another layout than TUM's, below the plan's folder; what cannot
/// be prepared is left out. Throws service::ConfigError for a folder that does not exist.
void prepare_inputs(const BenchmarkOptions& options, BenchmarkPlan& plan);

struct PlannedRun {
  const BenchmarkInput* input;  ///< of the plan
  std::string mode;
  int run;
};

/// What `benchmark` does not have yet. The first runs of everything come first, so that the table is soon complete.
std::vector<PlannedRun> missing_runs(const BenchmarkOptions& options, const BenchmarkPlan& plan,
                                     const Benchmark& benchmark);

/// The folder in which the boxes of the detector are kept, so that it looks at each image once; what a killed run left
/// half written there is removed.
void prepare_detections(const BenchmarkPlan& plan);

/// As tests/campaigns/perturbed_runs.py: every run but the first also moves the boxes' edges by 3 %.
ProgramTask task_of(const BenchmarkOptions& options, const BenchmarkPlan& plan, const PlannedRun& planned);

}  // namespace rtd::eval
