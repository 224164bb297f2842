// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

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

}  // namespace rtd::eval
