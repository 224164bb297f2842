// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::service {

/// The configuration is wrong; what() names file, key, value, allowed range and, for a typo, the nearest key.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Allowed range of a number, both ends included.
struct Range {
  double min = std::numeric_limits<double>::lowest();
  double max = std::numeric_limits<double>::max();
};

/// Reads, checks and prints the settings of plain config structs.
///
/// How a struct describes its settings, each in one place: the member has the default, and `bind`, right below the
/// members, has key, range and help text. The members then need no comments. `bind` is a template so that the header of
/// a core needs nothing of this one, and it costs nothing where it is not called:
///
///   struct FusionConfig {
///     double voxel_m = 0.02;
///     bool unknown_is_static = false;
///     NoiseConfig noise;
///
///     void bind(auto& binder) {
///       binder.field("voxel_m", voxel_m, {0.002, 1.0}, "side length of a voxel");
///       binder.field("unknown_is_static", unknown_is_static, "also fuse what the filter could not judge");
///       binder.section("noise", noise);  // keys `noise.*`
///     }
///   };
///
/// Bound settings must outlive the binder. Not thread-safe.
class ConfigBinder {
 public:
  ConfigBinder();
  ~ConfigBinder();
  ConfigBinder(const ConfigBinder&) = delete;
  ConfigBinder& operator=(const ConfigBinder&) = delete;

  void field(std::string_view key, bool& value, std::string_view help);
  void field(std::string_view key, int& value, Range range, std::string_view help);
  void field(std::string_view key, std::uint32_t& value, Range range, std::string_view help);
  void field(std::string_view key, double& value, Range range, std::string_view help);
  void field(std::string_view key, std::string& value, std::string_view help);
  void field(std::string_view key, std::vector<std::string>& value, std::string_view help);
  void field(std::string_view key, std::map<std::string, std::string>& value, std::string_view help);
  /// A string out of a fixed set. `former`: names of earlier versions, each read as the name that it has now.
  void choice(std::string_view key, std::string& value, std::vector<std::string> allowed, std::string_view help,
              std::map<std::string, std::string> former = {});

  /// Binds a nested struct: its keys begin with `prefix.`.
  template <class Struct>
  void section(std::string_view prefix, Struct& nested) {
    const std::string outer = prefix_;
    prefix_.append(prefix).append(".");
    nested.bind(*this);
    prefix_ = outer;
  }

  /// Loads a YAML file. Top-level sections named in `other_sections` belong to other services and are skipped, unless
  /// a key of this binder lies in them; any other unknown key, a wrong type or a value out of range throws ConfigError.
  void load_file(const std::string& path, const std::vector<std::string>& other_sections);
  /// The same for YAML text; errors name `origin`.
  void load_text(const std::string& yaml, const std::string& origin, const std::vector<std::string>& other_sections);
  /// Applies one "key=value" override (value parsed as YAML). With `other_sections`, a key of another service is
  /// skipped.
  void set(const std::string& assignment, const std::vector<std::string>& other_sections = {});
  /// Applies already parsed `key` and YAML text `value`.
  void set(const std::string& key, const std::string& yaml_value, const std::string& origin);
  /// All keys with the values in force, as YAML.
  std::string print() const;

 private:
  struct Setting;
  template <class T, class Allowed>
  void add(std::string_view key, T& value, std::string wanted, Allowed allowed, std::string_view help);
  std::vector<std::string> keys() const;
  bool is_of_others(const std::string& key, const std::vector<std::string>& other_sections) const;

  std::string prefix_;
  std::vector<Setting> settings_;
};

/// The candidate with the smallest edit distance to `name`; empty when none is near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace rtd::service
