// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace rtd::eval {

/// The mode that the others are compared with, and from which techniques are taken away.
inline constexpr const char* kBaseline = "rtd";

/// A switch of a service that can be turned off alone.
struct Technique {
  std::string key;      ///< "filter.techniques.depth_check"
  std::string without;  ///< what is done instead
  std::string name() const { return key.substr(key.rfind('.') + 1); }
};

/// The keys `<service>.techniques.*` in what `rtd-<service> --print-config` prints: a service knows best what it has.
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

/// A wrong request; what() names the word and the nearest right one.
class AblationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
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

/// Modes, then the baseline without each technique. Without detector the modes that are nothing without one are left
/// out, with a note. Throws AblationError.
AblationPlan plan_ablation(const AblationRequest& request, const std::vector<std::string>& modes,
                           const std::vector<Technique>& techniques);

/// Folder names for sources, each its own: "walk_xyz", "office", "office_2".
std::vector<std::string> source_names(const std::vector<std::string>& sources);

}  // namespace rtd::eval
