// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/experiment/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/bytes.hpp"
#include "common/io/input_file.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {
namespace {

using Report = nlohmann::json;

/// Of report.json; the first known place counts.
constexpr std::array<std::pair<const char*, const char*>, 15> kFigures{{
    {"ate_m", "/ate_rmse_m"},
    {"ate_poses", "/ate_poses"},
    {"online_ate_m", "/ate_online_rmse_m"},
    {"rpe_m", "/rpe_trans_rmse_m"},
    {"rpe_deg", "/rpe_rot_rmse_deg"},
    {"frames", "/frames_given"},
    {"coverage", "/coverage"},
    {"precision", "/removal/after_first_second/precision"},
    {"precision", "/removal/precision"},
    {"recall", "/removal/after_first_second/recall"},
    {"recall", "/removal/recall"},
    {"filter_ms", "/stage_ms/filter.total/p50"},
    {"slam_ms", "/stage_ms/slam.total/p50"},
    {"dangerous_share", "/integrity/dangerous_share"},
    {"needless_doubt_share", "/integrity/needless_doubt_share"},
}};

std::optional<double> number_at(const Report& report, const std::string& pointer) {
  const Report::json_pointer at(pointer);
  return report.contains(at) && report.at(at).is_number() ? std::optional(report.at(at).get<double>()) : std::nullopt;
}

Report report_of(const std::filesystem::path& folder) {
  return Report::parse(io::try_read_file(folder / "report.json", io::kResults).value_or(""), nullptr, false);
}

/// Frames by the state of their result -> shares of the frames. What has no pose is lost.
void add_shares(const Report& report, Figures& figures) {
  const double frames = figures.contains("frames") ? figures["frames"] : 0;
  if (frames <= 0 || !report.contains(Report::json_pointer("/integrity/states"))) return;
  double lost = frames;
  for (std::size_t i = 0; i < kTrackingStates; ++i) {
    const auto state = static_cast<msg::TrackingState>(i);
    if (!msg::has_pose(state)) continue;
    const double count = number_at(report, std::string("/integrity/states/") + to_string(state)).value_or(0);
    figures[std::string("share.") + to_string(state)] = count / frames;
    lost -= count;
  }
  figures["share.lost"] = std::max(0.0, lost) / frames;
}

/// Of the finite values.
Spread spread_of(const std::vector<double>& values) {
  std::vector<double> known;
  std::ranges::copy_if(values, std::back_inserter(known), [](double v) { return std::isfinite(v); });
  if (known.empty()) return {};
  std::ranges::sort(known);
  const std::size_t n = known.size();
  return {n % 2 == 1 ? known[n / 2] : (known[n / 2 - 1] + known[n / 2]) / 2, known.front(), known.back()};
}

ExperimentRow row_of(const Subject& subject, const std::string& variant, const Experiment& experiment) {
  ExperimentRow row{subject.name, variant};
  std::map<std::string, std::vector<double>> values;
  std::string trajectory;
  for (const ExperimentRun& run : experiment.results) {
    if (run.source != subject.source || run.variant != variant) continue;
    ++row.runs;
    if (!run.failure.empty()) {
      ++row.failed;
      row.failure = run.failure;
      continue;
    }
    for (const auto& [name, value] : run.figures) values[name].push_back(value);
    if (trajectory.empty()) trajectory = run.trajectory;
    row.differ = row.differ || (experiment.repeats && run.trajectory != trajectory);
  }
  for (const auto& [name, all] : values) row.figures[name] = spread_of(all);
  return row;
}

const ExperimentRow* find_row(const std::vector<ExperimentRow>& rows, const std::string& subject,
                              const std::string& variant) {
  const auto found =
      std::ranges::find_if(rows, [&](const auto& row) { return row.subject == subject && row.variant == variant; });
  return found == rows.end() ? nullptr : &*found;
}

/// Of the medians of one variant on the sequences of the dataset's mean; empty unless all are there.
std::optional<ExperimentRow> mean_row(Dataset dataset, const std::string& variant,
                                      const std::vector<ExperimentRow>& rows) {
  const auto sequences = mean_sequences(dataset);
  ExperimentRow mean{kMeanName, variant};
  double sum_m = 0;
  for (const char* sequence : sequences) {
    const ExperimentRow* const row = find_row(rows, sequence, variant);
    if (row == nullptr) return std::nullopt;
    sum_m += row->figure("ate_m").median;
    mean.runs += row->runs;
  }
  if (sequences.empty() || !std::isfinite(sum_m)) return std::nullopt;
  const double mean_m = sum_m / static_cast<double>(sequences.size());
  mean.figures["ate_m"] = {mean_m, mean_m, mean_m};
  return mean;
}

void add_ratios(std::vector<ExperimentRow>& rows) {
  for (ExperimentRow& row : rows) {
    const ExperimentRow* const baseline = find_row(rows, row.subject, kBaseline);
    const double ratio = baseline ? row.figure("ate_m").median / baseline->figure("ate_m").median : std::nan("");
    if (std::isfinite(ratio)) row.figures["ratio"] = {ratio, ratio, ratio};
  }
}

}  // namespace

std::optional<Figures> read_figures(const std::filesystem::path& folder) {
  const Report report = report_of(folder);
  if (!report.is_object() || !report.contains("frames_in")) return std::nullopt;
  Figures figures;
  for (const auto& [name, pointer] : kFigures) {
    if (const auto value = number_at(report, pointer)) figures.emplace(name, *value);
  }
  if (const auto delay_s = number_at(report, "/integrity/delay_s_max")) figures["delay_s_max"] = *delay_s;
  add_shares(report, figures);
  return figures;
}

std::optional<std::string> last_event(const std::filesystem::path& folder) {
  const Report report = report_of(folder);
  if (!report.is_object() || !report.contains("events") || report["events"].empty()) return std::nullopt;
  return report["events"].back().get<std::string>();
}

const ExperimentRun* find_run(const Experiment& experiment, const std::string& source, const std::string& variant,
                              int run) {
  const auto found = std::ranges::find_if(experiment.results, [&](const ExperimentRun& r) {
    return r.failure.empty() && r.source == source && r.variant == variant && r.run == run;
  });
  return found == experiment.results.end() ? nullptr : &*found;
}

Spread ExperimentRow::figure(const std::string& name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? Spread{} : found->second;
}

std::vector<ExperimentRow> summarize(const Experiment& experiment) {
  std::vector<ExperimentRow> rows;
  for (const Subject& subject : experiment.subjects) {
    for (const Variant& variant : experiment.variants) {
      ExperimentRow row = row_of(subject, variant.name, experiment);
      if (row.runs > 0) rows.push_back(std::move(row));
    }
  }
  if (const NamedDataset* const dataset = find_dataset(experiment.settings.value("dataset", ""))) {
    std::vector<ExperimentRow> means;
    for (const Variant& variant : experiment.variants) {
      if (auto mean = mean_row(dataset->dataset, variant.name, rows)) means.push_back(*std::move(mean));
    }
    rows.insert(rows.end(), means.begin(), means.end());
  }
  add_ratios(rows);
  return rows;
}

std::optional<Change> change_of(const ExperimentRow& now, const std::vector<ExperimentRow>& before) {
  constexpr int kEnoughRuns = 3;
  const ExperimentRow* const then = find_row(before, now.subject, now.variant);
  if (then == nullptr) return std::nullopt;
  const Spread then_m = then->figure("ate_m"), now_m = now.figure("ate_m");
  if (!(then_m.median > 0) || !std::isfinite(now_m.median)) return std::nullopt;
  Change change{then_m.median, now_m.median, ""};
  const bool enough = std::min(then->runs - then->failed, now.runs - now.failed) >= kEnoughRuns;
  if (enough && now.subject != kMeanName)
    change.verdict = now_m.max < then_m.min ? "better" : now_m.min > then_m.max ? "worse" : "";
  return change;
}

std::optional<double> remaining_s(const Experiment& experiment) {
  const auto mean_s = [&](const std::string& source, double& runs) {
    double sum_s = 0;
    runs = 0;
    for (const ExperimentRun& run : experiment.results) {
      if (!source.empty() && run.source != source) continue;
      sum_s += run.duration_s;
      ++runs;
    }
    return sum_s / std::max(1.0, runs);
  };
  double all_runs = 0, remaining = 0;
  const double mean_of_all_s = mean_s("", all_runs);
  if (all_runs == 0) return std::nullopt;
  const auto planned = static_cast<double>(experiment.variants.size()) * experiment.runs;
  for (const Subject& subject : experiment.subjects) {
    double runs = 0;
    const double of_subject_s = mean_s(subject.source, runs);
    remaining += std::max(0.0, planned - runs) * (runs > 0 ? of_subject_s : mean_of_all_s);
  }
  return remaining / experiment.jobs;
}

}  // namespace rtd::eval
