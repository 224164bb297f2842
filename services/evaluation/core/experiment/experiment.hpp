// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/datasets/dataset.hpp"

namespace rtd::eval {

/// The mode that the others are compared with, and whose techniques are switched off one by one.
inline constexpr const char* kBaseline = "rtd";

/// A part of a service that can be switched off alone.
struct Technique {
  std::string key;      ///< "filter.techniques.depth_check"
  std::string without;  ///< what is done instead
  std::string name() const { return key.substr(key.rfind('.') + 1); }
};

/// The keys `<service>.techniques.*` in the output of `rtd-<service> --print-config`.
std::vector<Technique> read_techniques(const std::string& printed_config, const std::string& service);

/// What is run on every source of an experiment.
struct Variant {
  std::string name;  ///< "geometry", "without depth_check"
  std::string mode;
  std::vector<std::string> settings;  ///< "key=value"
  std::string meaning;
  std::string folder() const;  ///< the name as a folder name
};

struct VariantRequest {
  std::vector<std::string> modes;    ///< empty: all
  std::vector<std::string> without;  ///< techniques, by name or key; empty: all; "none": none
  bool detector = true;
};

struct VariantPlan {
  std::vector<Variant> variants;  ///< modes first
  std::vector<std::string> notes;
};

/// Modes, then the baseline without each technique. Without a detector, the modes that need one are left out, with a
/// note. Throws service::ConfigError naming a wrong value and the nearest valid one.
VariantPlan plan_variants(const VariantRequest& request, const std::vector<std::string>& modes,
                          const std::vector<Technique>& techniques);

/// A unique folder name for each source: "walk_xyz", "office", "office_2".
std::vector<std::string> source_names(const std::vector<std::string>& sources);

/// What every variant is run on.
struct Subject {
  std::string name;    ///< short and unique
  std::string source;  ///< URI
};

/// The figures of a run by name; what is unknown is not in it (docs/evaluation.md lists them).
using Figures = std::map<std::string, double>;

/// Reads the report.json that `rtd run` wrote to `folder`; empty when it cannot be read.
std::optional<Figures> read_figures(const std::filesystem::path& folder);
/// The last event in the report.json of `folder`: when the run failed, the reason. Empty when there is none.
std::optional<std::string> last_event(const std::filesystem::path& folder);

/// One run of a variant.
struct ExperimentRun {
  std::string source, variant;
  int run = 1;
  double duration_s = 0;
  std::string failure;  ///< why it does not count; empty = it counts
  Figures figures;
  std::string trajectory = "";  ///< checksum of its bytes
};

/// The plan of `rtd ablate` or `rtd benchmark` and the runs so far.
struct Experiment {
  std::string name;         ///< "ablation" or "benchmark": of its files
  nlohmann::json settings;  ///< what runs depend on: they are kept only while none of it changes
  std::vector<Subject> subjects;
  std::vector<Variant> variants;
  int runs = 1;          ///< of each
  int jobs = 1;          ///< runs next to each other
  bool repeats = false;  ///< the runs of a variant are to give the same bytes
  bool complete = false;
  std::vector<ExperimentRun> results;
  std::vector<LeftOut> left_out;
  std::vector<std::string> notes;
};

/// The run, if it is there and counts.
const ExperimentRun* find_run(const Experiment& experiment, const std::string& source, const std::string& variant,
                              int run);

/// Median and extremes of a figure over several runs; NaN when it is unknown.
struct Spread {
  double median = std::numeric_limits<double>::quiet_NaN();
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

/// All runs of a variant on a subject.
struct ExperimentRow {
  std::string subject, variant;
  int runs = 0, failed = 0;
  std::string failure = "";                    ///< of the last run that failed
  bool differ = false;                         ///< runs that should be equal have different trajectories
  std::map<std::string, Spread> figures = {};  ///< of the runs that count; "ratio": ATE to the baseline's
  /// All NaN when no run has the figure.
  Spread figure(const std::string& name) const;
};

inline constexpr const char* kMeanName = "mean";

/// One row per subject and variant that was run, in the order of the plan. For datasets with a mean (mean_sequences())
/// that has all its sequences also the row kMeanName of each variant: the mean of their medians.
std::vector<ExperimentRow> summarize(const Experiment& experiment);

/// What a row is next to the same row of another experiment.
struct Change {
  double before_m = 0, now_m = 0;  ///< median ATE
  /// "better" or "worse" when the ranges of at least three runs each do not overlap, else empty
  std::string verdict;
  double percent() const { return 100 * (now_m / before_m - 1); }
};
std::optional<Change> change_of(const ExperimentRow& now, const std::vector<ExperimentRow>& before);

/// Estimated duration of the remaining runs, from the runs of the same source so far; empty before the first run.
std::optional<double> remaining_s(const Experiment& experiment);

/// ablation.json and benchmark.json (keys: docs/evaluation.md)
nlohmann::ordered_json experiment_json(const Experiment& experiment);
/// Reads what experiment_json() writes. Throws service::ConfigError naming `file`.
Experiment read_experiment(const std::string& file);

/// What was left out, what failed, what is unexpected.
std::vector<std::string> notes_of(const Experiment& experiment);

/// The value in a format such as "{:.3f}"; "-" when it is unknown.
std::string number_text(double value, const char* format);

/// Headings and cells of the table; "-" = unknown. `before`: of --compare, else null.
struct ExperimentTable {
  std::vector<ExperimentRow> rows;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> cells;  ///< by row
};
ExperimentTable table_of(const Experiment& experiment, const Experiment* before);

/// Tables for the terminal, aligned; the same in Markdown; the same as a page with charts. With notes: what was left
/// out, failed or is unexpected.
std::string experiment_text(const Experiment& experiment, const Experiment* before);
std::string experiment_markdown(const Experiment& experiment, const Experiment* before);
std::string experiment_html(const Experiment& experiment, const Experiment* before);

}  // namespace rtd::eval
