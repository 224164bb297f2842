// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/ablation/ablation.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/filter_modes.hpp"
#include "common/service/config.hpp"

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
  const std::string near = service::nearest_name(word, known);
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  throw service::ConfigError("unknown " + what + " '" + io::abridged(word) + "'" +
                             (near.empty() ? "; known: " + all : ", did you mean '" + near + "'?"));
}

std::vector<Variant> plan_modes(const AblationRequest& request, const std::vector<std::string>& modes,
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

std::vector<Technique> chosen_techniques(const AblationRequest& request, const std::vector<Technique>& techniques) {
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

double number(const nlohmann::json& json, const char* pointer) {
  const nlohmann::json::json_pointer at(pointer);
  return json.contains(at) && json.at(at).is_number() ? json.at(at).get<double>() : Measurement::kUnknown;
}

double first_known(double a, double b) {
  return std::isfinite(a) ? a : b;
}

nlohmann::json report_of(const std::filesystem::path& folder) {
  return nlohmann::json::parse(io::try_read_file(folder / "report.json", io::kResults).value_or(""), nullptr, false);
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
    if (run->failure.empty()) trajectories.push_back(io::try_read_file(run->trajectory, io::kPoses).value_or(""));
  }
  return std::ranges::any_of(trajectories, [&](const auto& t) { return t != trajectories[0]; });
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

AblationPlan plan_ablation(const AblationRequest& request, const std::vector<std::string>& modes,
                           const std::vector<Technique>& techniques) {
  AblationPlan plan;
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

std::optional<Measurement> read_measurement(const std::filesystem::path& folder) {
  const nlohmann::json json = report_of(folder);
  if (!json.is_object() || !json.contains("frames_in")) return std::nullopt;
  Measurement m;
  m.ate_m = number(json, "/ate_rmse_m");
  m.ate_poses = number(json, "/ate_poses");
  m.frames = number(json, "/frames_given");
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
  const nlohmann::json json = report_of(folder);
  if (!json.is_object() || !json.contains("events") || json["events"].empty()) return std::nullopt;
  return json["events"].back().get<std::string>();
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
