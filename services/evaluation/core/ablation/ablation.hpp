// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/report/spread.hpp"

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

/// One column of the experiment: what is run on every source.
struct Variant {
  std::string name;  ///< "geometry", "without depth_check"
  std::string mode;
  std::vector<std::string> settings;  ///< "key=value"
  std::string meaning;
  bool is_mode() const { return settings.empty(); }
  std::string folder() const;  ///< the name as a folder name
};

struct AblationRequest {
  std::vector<std::string> modes;    ///< empty: all
  std::vector<std::string> without;  ///< techniques, by name or key; empty: all; "none": none
  bool detector = true;
};

struct AblationPlan {
  std::vector<Variant> variants;  ///< modes first
  std::vector<std::string> notes;
};

/// Modes, then the baseline without each technique. Without a detector, the modes that need one are left out, with a
/// note. Throws service::ConfigError naming a wrong value and the nearest valid one.
AblationPlan plan_ablation(const AblationRequest& request, const std::vector<std::string>& modes,
                           const std::vector<Technique>& techniques);

/// A unique folder name for each source: "walk_xyz", "office", "office_2".
std::vector<std::string> source_names(const std::vector<std::string>& sources);

/// One run of one variant on one source. Doubles are NaN where unknown.
struct Measurement {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::string source, variant;
  int run = 1;
  std::string failure;  ///< why the run does not count; empty = it counts
  double ate_m = kUnknown, ate_poses = kUnknown, rpe_m = kUnknown, rpe_deg = kUnknown, coverage = kUnknown,
         frames = kUnknown;
  double precision = kUnknown, recall = kUnknown;  ///< after the first second, of the whole run when it is shorter
  double filter_ms = kUnknown;                     ///< median, ORB extraction included
  double duration_s = 0;                           ///< of the run, for the estimate of the remaining time
  std::string trajectory;                          ///< file
};

/// Reads the report.json that `rtd run` wrote to `folder`; empty when it cannot be read.
std::optional<Measurement> read_measurement(const std::filesystem::path& folder);
/// The last event in the report.json of `folder`: when the run failed, the reason. Empty when there is none.
std::optional<std::string> last_event(const std::filesystem::path& folder);

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

/// The rows of one source.
std::vector<AblationRow> rows_of(const std::vector<AblationRow>& rows, const std::string& source);

/// Headings and cells of one row of the table; "-" = unknown. With several unequal runs: median (min..max).
std::vector<std::string> ablation_head();
std::vector<std::string> ablation_cells(const AblationRow& row);

/// Notes beside the table: what was left out, what failed, what is unexpected.
std::vector<std::string> ablation_notes(const Ablation& ablation, const std::vector<AblationRow>& rows);

/// Tables for the terminal, aligned.
std::string ablation_text(const Ablation& ablation);
/// ablation.md
std::string ablation_markdown(const Ablation& ablation);
/// ablation.json (keys: docs/evaluation.md)
nlohmann::ordered_json ablation_json(const Ablation& ablation);

/// ablation.html: for each source the errors of the modes, the effect of each technique, the numbers. Self-contained.
std::string ablation_html(const Ablation& ablation);

}  // namespace rtd::eval
