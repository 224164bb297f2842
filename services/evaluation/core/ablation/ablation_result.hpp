// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/ablation/ablation_plan.hpp"

namespace rtd::eval {

/// One run of one variant on one source. Doubles are NaN where unknown.
struct Measurement {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::string source, variant;
  int run = 1;
  std::string failure;  ///< why the run does not count; empty = it counts
  double ate_m = kUnknown, rpe_m = kUnknown, rpe_deg = kUnknown, coverage = kUnknown;
  double precision = kUnknown, recall = kUnknown;  ///< after the first second, of the whole run when it is shorter
  double filter_ms = kUnknown;                     ///< median, ORB extraction included
  double duration_s = 0;                           ///< of the run, for the estimate of the remaining time
  std::string trajectory;                          ///< file
};

/// Reads the report.json that `rtd run` wrote to `folder`; empty when it cannot be read.
std::optional<Measurement> read_measurement(const std::filesystem::path& folder);
/// The last event in the report.json of `folder`: when the run failed, the reason. Empty when there is none.
std::optional<std::string> last_event(const std::filesystem::path& folder);

/// Median and extremes of the known values.
struct Spread {
  double median = Measurement::kUnknown, min = Measurement::kUnknown, max = Measurement::kUnknown;
};
Spread spread_of(const std::vector<double>& values);

/// All runs of a variant on a source.
struct AblationRow {
  std::string source;
  Variant variant;
  int runs = 0, failed = 0;
  std::string failure;  ///< of the last run that failed
  Spread ate_m, rpe_m, rpe_deg, coverage, precision, recall, filter_ms;
  double ratio = Measurement::kUnknown;  ///< ATE divided by the baseline's on the same source
  bool unlike = false;                   ///< runs that should be equal have different trajectories
};

/// The plan of an ablation and its measurements so far.
struct Ablation {
  std::string version, pace;
  int runs = 1;
  std::vector<std::string> sources;       ///< as given
  std::vector<std::string> source_names;  ///< short, one per source
  AblationPlan plan;
  std::vector<Measurement> measurements;
  std::vector<std::string> notes;
  bool complete = false;
};

/// One row per source and variant that was run, in the order of the plan.
std::vector<AblationRow> summarize(const Ablation& ablation);

/// Estimated duration of the remaining runs, from the runs of the same source so far; empty before the first run.
std::optional<double> remaining_s(const Ablation& ablation);

}  // namespace rtd::eval
