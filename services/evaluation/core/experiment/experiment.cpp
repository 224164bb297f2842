// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/experiment/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "common/io/bytes.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/service/config.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {
namespace {

bool removes_nothing_without_detector(const std::string& mode) {
  const msg::NamedFilterMode* const known = msg::find_filter_mode(mode);
  return known != nullptr && known->boxes == msg::BoxUse::kEssential;
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

std::size_t indent_of(const std::string& line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

[[noreturn]] void refuse(const std::string& what, const std::string& word, const std::vector<std::string>& known) {
  const std::string near = io::nearest_name(word, known);
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  throw service::ConfigError("unknown " + what + " '" + io::abridged(word) + "'" +
                             (near.empty() ? "; known: " + all : ", did you mean '" + near + "'?"));
}

std::vector<Variant> plan_modes(const VariantRequest& request, const std::vector<std::string>& modes,
                                std::vector<std::string>& notes) {
  for (const std::string& mode : request.modes) {
    if (!contains(modes, mode)) refuse("mode", mode, modes);
  }
  std::vector<Variant> variants;
  for (const std::string& mode : modes) {
    if (!request.modes.empty() && !contains(request.modes, mode)) continue;
    if (!request.detector && removes_nothing_without_detector(mode)) {
      notes.push_back("mode " + mode + " is left out: no detector");
    } else {
      variants.push_back({mode, mode, {}, ""});
    }
  }
  return variants;
}

std::vector<Technique> chosen_techniques(const VariantRequest& request, const std::vector<Technique>& techniques) {
  if (request.without.empty()) return techniques;
  std::vector<std::string> names;
  for (const Technique& technique : techniques) names.push_back(technique.name());
  std::vector<Technique> chosen;
  for (const std::string& word : request.without) {
    if (word == "none") continue;
    const auto found =
        std::ranges::find_if(techniques, [&](const Technique& t) { return t.key == word || t.name() == word; });
    if (found == techniques.end()) refuse("technique", word, names);
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace

std::string Variant::folder() const {
  std::string name_of_folder = name;
  std::ranges::replace(name_of_folder, ' ', '_');
  return name_of_folder;
}

std::vector<Technique> read_techniques(const std::string& printed_config, const std::string& service) {
  constexpr std::size_t kGroup = 2, kEntry = 4;  // indents
  std::vector<Technique> techniques;
  bool in_service = false, in_group = false;
  std::istringstream lines(printed_config);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = indent_of(line);
    if (indent == 0) in_service = line.starts_with(service + ":");
    if (indent <= kGroup) in_group = in_service && indent == kGroup && line.starts_with("  techniques:");
    if (!in_group || indent != kEntry) continue;
    const std::size_t hash = line.find("# ");
    std::string without = hash == std::string::npos ? "" : line.substr(hash + 2);
    if (without.starts_with("off: ")) without.erase(0, 5);
    techniques.push_back({service + ".techniques." + line.substr(indent, line.find(':') - indent), without});
  }
  return techniques;
}

VariantPlan plan_variants(const VariantRequest& request, const std::vector<std::string>& modes,
                          const std::vector<Technique>& techniques) {
  VariantPlan plan;
  plan.variants = plan_modes(request, modes, plan.notes);
  const std::vector<Technique> chosen = chosen_techniques(request, techniques);
  const bool has_baseline =
      std::ranges::any_of(plan.variants, [](const Variant& variant) { return variant.name == kBaseline; });
  if (!has_baseline && !chosen.empty()) plan.variants.push_back({kBaseline, kBaseline, {}, ""});
  for (const Technique& technique : chosen) {
    plan.variants.push_back({"without " + technique.name(), kBaseline, {technique.key + "=false"}, technique.without});
  }
  if (plan.variants.empty()) throw service::ConfigError("nothing to run: all modes are left out");
  return plan;
}

std::vector<std::string> source_names(const std::vector<std::string>& sources) {
  std::vector<std::string> names;
  for (const std::string& source : sources) {
    std::string path = source.substr(0, source.find('?'));
    path.erase(0, path.find(':') == std::string::npos ? 0 : path.find(':') + 1);
    while (path.size() > 1 && path.back() == '/') path.pop_back();
    std::string name = std::filesystem::path(path).filename().string();
    for (char& c : name) {
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
    }
    if (name.empty() || name.find_first_not_of('.') == std::string::npos) name = "source";
    const std::string base = name;
    for (int n = 2; contains(names, name); ++n) name = base + "_" + std::to_string(n);
    names.push_back(name);
  }
  return names;
}

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
