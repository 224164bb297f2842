// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/experiment/variants.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>

#include "common/io/printable.hpp"
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

}  // namespace rtd::eval
