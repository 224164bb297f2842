// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/benchmark/benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "common/msg/filter_modes.hpp"
#include "services/evaluation/core/benchmark/published.hpp"
#include "services/evaluation/core/integrity/integrity.hpp"

namespace rtd::eval {
namespace {

/// The numbers of an object and of those in it.
void flatten(const nlohmann::json& object, const std::string& prefix, Figures& figures) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_number()) figures[prefix + key] = value.get<double>();
    if (value.is_object()) flatten(value, prefix + key + ".", figures);
  }
}

std::optional<double> find(const Figures& figures, const std::string& name) {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : std::optional(found->second);
}

/// Frames by the state of their result -> shares of the frames. What has no pose is lost.
void add_shares(const nlohmann::json& printed, Figures& figures) {
  const double frames = find(figures, "frames").value_or(0);
  if (frames <= 0 || !printed.contains("states")) return;
  double lost = frames;
  for (std::size_t i = 0; i < kTrackingStates; ++i) {
    const auto state = static_cast<msg::TrackingState>(i);
    if (!msg::has_pose(state)) continue;
    const double count = find(figures, std::string("states.") + to_string(state)).value_or(0);
    figures[std::string("share.") + to_string(state)] = count / frames;
    lost -= count;
  }
  figures["share.lost"] = std::max(0.0, lost) / frames;
}

BenchmarkRow row_of(const std::string& sequence, const std::string& mode, const std::vector<BenchmarkRun>& runs) {
  BenchmarkRow row{sequence, mode, 0, 0, "", {}};
  std::map<std::string, std::vector<double>> values;
  for (const BenchmarkRun& run : runs) {
    if (run.sequence != sequence || run.mode != mode) continue;
    ++row.runs;
    if (run.failure.empty()) {
      for (const auto& [name, value] : run.figures) values[name].push_back(value);
    } else {
      ++row.failed;
      row.failure = run.failure;
    }
  }
  for (const auto& [name, all] : values) row.figures[name] = spread_of(all);
  return row;
}

/// Of the medians of one mode on the sequences of the dataset's mean; empty unless all are there.
std::optional<BenchmarkRow> mean_row(Dataset dataset, const std::string& mode, const std::vector<BenchmarkRow>& rows) {
  const auto sequences = mean_sequences(dataset);
  double sum_m = 0;
  int runs = 0;
  for (const char* sequence : sequences) {
    const auto row =
        std::ranges::find_if(rows, [&](const BenchmarkRow& r) { return r.sequence == sequence && r.mode == mode; });
    if (row == rows.end()) return std::nullopt;
    sum_m += row->figure("ate_m").median;
    runs += row->runs;
  }
  if (sequences.empty() || !std::isfinite(sum_m)) return std::nullopt;
  const double mean_m = sum_m / static_cast<double>(sequences.size());
  return BenchmarkRow{kMeanName, mode, runs, 0, "", {{"ate_m", {mean_m, mean_m, mean_m}}}};
}

}  // namespace

Perturbation perturbation_of(int run) {
  if (run == 0) return {};
  return {run % 10, 800 + 50 * (7 * run % 9)};
}

Figures figures_of(const nlohmann::json& printed) {
  Figures figures;
  flatten(printed, "", figures);
  const auto filter_ms = find(figures, "filter_ms"), slam_ms = find(figures, "slam_ms");
  if (filter_ms || slam_ms) figures["ms"] = filter_ms.value_or(0) + slam_ms.value_or(0);
  add_shares(printed, figures);
  return figures;
}

const BenchmarkRun* find_run(const Benchmark& benchmark, const std::string& folder, const std::string& mode, int run) {
  const auto found = std::ranges::find_if(benchmark.runs, [&](const BenchmarkRun& r) {
    return r.failure.empty() && r.folder == folder && r.mode == mode && r.run == run;
  });
  return found == benchmark.runs.end() ? nullptr : &*found;
}

Spread BenchmarkRow::figure(const std::string& name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? Spread{} : found->second;
}

std::vector<BenchmarkRow> summarize(const Benchmark& benchmark) {
  std::set<std::string> sequences;
  for (const BenchmarkRun& run : benchmark.runs) sequences.insert(run.sequence);
  std::vector<BenchmarkRow> rows;
  for (const std::string& sequence : sequences) {
    for (const std::string& mode : msg::filter_mode_names()) {
      BenchmarkRow row = row_of(sequence, mode, benchmark.runs);
      if (row.runs > 0) rows.push_back(std::move(row));
    }
  }
  const NamedDataset* const dataset = find_dataset(benchmark.settings.dataset);
  if (dataset == nullptr) return rows;
  std::vector<BenchmarkRow> means;
  for (const std::string& mode : msg::filter_mode_names()) {
    if (auto mean = mean_row(dataset->dataset, mode, rows)) means.push_back(*std::move(mean));
  }
  rows.insert(rows.end(), means.begin(), means.end());
  return rows;
}

std::optional<Change> change_of(const BenchmarkRow& now, const std::vector<BenchmarkRow>& before) {
  constexpr int kEnoughRuns = 3;
  const auto found = std::ranges::find_if(
      before, [&](const BenchmarkRow& row) { return row.sequence == now.sequence && row.mode == now.mode; });
  if (found == before.end()) return std::nullopt;
  const Spread then_m = found->figure("ate_m"), now_m = now.figure("ate_m");
  if (!(then_m.median > 0) || !std::isfinite(now_m.median)) return std::nullopt;
  Change change{then_m.median, now_m.median, ""};
  const bool enough = std::min(found->runs - found->failed, now.runs - now.failed) >= kEnoughRuns;
  if (enough && now.sequence != kMeanName)
    change.verdict = now_m.max < then_m.min ? "better" : now_m.min > then_m.max ? "worse" : "";
  return change;
}

}  // namespace rtd::eval
