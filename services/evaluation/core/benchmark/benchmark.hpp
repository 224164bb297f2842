// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/benchmark/dataset.hpp"
#include "services/evaluation/core/report/spread.hpp"

namespace rtd::eval {

/// What one run of several does differently, because a feature more or less changes a trajectory by tens of percent.
struct Perturbation {
  int first_frame = 0;
  int feature_count = 1000;
};

/// First frames 0 to 9 and 800 to 1200 features; run 0 is the plain one.
Perturbation perturbation_of(int run);

/// The figures of a run by name: the numbers in the line of JSON that the program printed, those of objects as
/// "object.key", and what is computed of them: "ms" (a frame in filter and slam), "share.ok", "share.doubtful",
/// "share.odometry", "share.predicted", "share.lost". What is unknown is not in it.
using Figures = std::map<std::string, double>;
Figures figures_of(const nlohmann::json& printed);

/// One run of a mode on a sequence.
struct BenchmarkRun {
  std::string sequence, folder, mode;
  int run = 0;
  double duration_s = 0;
  std::string failure;  ///< why it does not count; empty = it counts
  Figures figures;
};

/// What a run depends on: runs are kept only while none of it changes.
struct BenchmarkSettings {
  std::string version;
  std::string build;     ///< identifies the program that ran
  std::string dataset;   ///< its name
  std::string detector;  ///< file name of its network, or "off"
  std::uint64_t frames = 0;
  std::vector<std::string> set;  ///< "key=value"
  bool operator==(const BenchmarkSettings&) const = default;
};

/// All runs so far.
struct Benchmark {
  BenchmarkSettings settings;
  int jobs = 1;  ///< runs beside each other
  bool complete = false;
  std::vector<BenchmarkRun> runs;
  std::vector<LeftOut> left_out;
  std::vector<std::string> notes;
};

/// The run, if it is there and counts.
const BenchmarkRun* find_run(const Benchmark& benchmark, const std::string& folder, const std::string& mode, int run);

/// All runs of a mode on a sequence.
struct BenchmarkRow {
  std::string sequence, mode;
  int runs = 0, failed = 0;
  std::string failure;                    ///< of the last run that failed
  std::map<std::string, Spread> figures;  ///< of the runs that count
  /// All NaN when no run has the figure.
  Spread figure(const std::string& name) const;
};

/// One row per sequence and mode, sequences by name, modes in the order of the filter's table. For datasets with a mean
/// (mean_sequences()) that has all its sequences also the row kMeanName of each mode: the mean of their medians.
std::vector<BenchmarkRow> summarize(const Benchmark& benchmark);

/// What a row is beside the same row of another benchmark.
struct Change {
  double before_m = 0, now_m = 0;  ///< median ATE
  /// "better" or "worse" when the ranges of at least three runs each do not overlap, else empty
  std::string verdict;
  double percent() const { return 100 * (now_m / before_m - 1); }
};
std::optional<Change> change_of(const BenchmarkRow& now, const std::vector<BenchmarkRow>& before);

/// benchmark.json (keys: docs/evaluation.md)
nlohmann::ordered_json benchmark_json(const Benchmark& benchmark);

/// Reads what benchmark_json() writes. Throws service::ConfigError naming `file`.
Benchmark read_benchmark(const std::string& file);

/// Tables for the terminal. `before`: of --compare, else null.
std::string benchmark_text(const Benchmark& benchmark, const Benchmark* before);

/// The page: for each sequence our modes beside published figures with their source. Self-contained.
std::string benchmark_html(const Benchmark& benchmark, const Benchmark* before);

}  // namespace rtd::eval
