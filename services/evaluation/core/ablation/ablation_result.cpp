// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/ablation/ablation_result.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace rtd::eval {
namespace {

double number(const nlohmann::json& json, const char* pointer) {
  const nlohmann::json::json_pointer at(pointer);
  return json.contains(at) && json.at(at).is_number() ? json.at(at).get<double>() : Measurement::kUnknown;
}

double first_known(double a, double b) {
  return std::isfinite(a) ? a : b;
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

AblationRow row_of(const std::string& source, const Variant& variant, const std::vector<const Measurement*>& runs) {
  AblationRow row{source, variant, static_cast<int>(runs.size()), 0, "", {}, {}, {}, {}, {}, {}, {}};
  const auto spread = [&](double Measurement::*value) {
    std::vector<double> values;
    for (const Measurement* run : runs) {
      if (run->failure.empty()) values.push_back(run->*value);
    }
    return spread_of(values);
  };
  for (const Measurement* run : runs) {
    if (run->failure.empty()) continue;
    ++row.failed;
    row.failure = run->failure;
  }
  row.ate_m = spread(&Measurement::ate_m);
  row.rpe_m = spread(&Measurement::rpe_m);
  row.rpe_deg = spread(&Measurement::rpe_deg);
  row.coverage = spread(&Measurement::coverage);
  row.precision = spread(&Measurement::precision);
  row.recall = spread(&Measurement::recall);
  row.filter_ms = spread(&Measurement::filter_ms);
  return row;
}

bool unlike(const std::vector<const Measurement*>& runs) {
  std::vector<std::string> trajectories;
  for (const Measurement* run : runs) {
    if (run->failure.empty()) trajectories.push_back(content_of(run->trajectory));
  }
  return std::any_of(trajectories.begin(), trajectories.end(), [&](const auto& t) { return t != trajectories[0]; });
}

}  // namespace

std::optional<Measurement> read_measurement(const std::filesystem::path& folder) {
  const nlohmann::json json = nlohmann::json::parse(content_of((folder / "report.json").string()), nullptr, false);
  if (!json.is_object() || !json.contains("frames_in")) return std::nullopt;
  Measurement m;
  m.ate_m = number(json, "/ate_rmse_m");
  m.rpe_m = number(json, "/rpe_trans_rmse_m");
  m.rpe_deg = number(json, "/rpe_rot_rmse_deg");
  m.coverage = number(json, "/coverage");
  m.precision = first_known(number(json, "/removal/after_first_second/precision"), number(json, "/removal/precision"));
  m.recall = first_known(number(json, "/removal/after_first_second/recall"), number(json, "/removal/recall"));
  m.filter_ms = number(json, "/stage_ms/filter.total/p50");
  m.trajectory = (folder / "trajectory.txt").string();
  return m;
}

std::optional<std::string> last_event(const std::filesystem::path& folder) {
  const nlohmann::json json = nlohmann::json::parse(content_of((folder / "report.json").string()), nullptr, false);
  if (!json.is_object() || !json.contains("events") || json["events"].empty()) return std::nullopt;
  return json["events"].back().get<std::string>();
}

Spread spread_of(const std::vector<double>& values) {
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double v) { return std::isfinite(v); });
  if (known.empty()) return {};
  std::sort(known.begin(), known.end());
  const std::size_t n = known.size();
  return {n % 2 == 1 ? known[n / 2] : (known[n / 2 - 1] + known[n / 2]) / 2, known.front(), known.back()};
}

std::vector<AblationRow> summarize(const Ablation& ablation) {
  std::vector<AblationRow> rows;
  for (const std::string& source : ablation.source_names) {
    const std::size_t first = rows.size();
    double baseline_m = Measurement::kUnknown;
    for (const Variant& variant : ablation.plan.variants) {
      std::vector<const Measurement*> runs;
      for (const Measurement& m : ablation.measurements) {
        if (m.source == source && m.variant == variant.name) runs.push_back(&m);
      }
      if (runs.empty()) continue;
      rows.push_back(row_of(source, variant, runs));
      rows.back().unlike = ablation.pace == "lockstep" && unlike(runs);
      if (variant.name == kBaseline) baseline_m = rows.back().ate_m.median;
    }
    for (std::size_t i = first; i < rows.size(); ++i) rows[i].ratio = rows[i].ate_m.median / baseline_m;
  }
  return rows;
}

std::optional<double> remaining_s(const Ablation& ablation) {
  double all_s = 0, all_runs = 0, remaining = 0;
  for (const Measurement& m : ablation.measurements) {
    all_s += m.duration_s;
    ++all_runs;
  }
  if (all_runs == 0) return std::nullopt;
  const auto planned = static_cast<double>(ablation.plan.variants.size()) * ablation.runs;
  for (const std::string& source : ablation.source_names) {
    double spent_s = 0, runs = 0;
    for (const Measurement& m : ablation.measurements) {
      if (m.source != source) continue;
      spent_s += m.duration_s;
      ++runs;
    }
    remaining += (planned - runs) * (runs > 0 ? spent_s / runs : all_s / all_runs);
  }
  return remaining;
}

}  // namespace rtd::eval
