// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
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

/// Ties the fields of plain config structs to dotted keys. A config struct keeps its defaults in itself and offers
///   void bind(rtd::service::ConfigBinder& binder) { binder.field("max_depth_m", max_depth_m, {0.3, 20.0}, "what it
///   is"); }
/// The binder then loads YAML, applies key=value overrides, checks ranges and prints what is in force.
/// Bound fields must outlive the binder. Not thread-safe.
class ConfigBinder {
 public:
  void field(const std::string& key, bool& value, const std::string& help);
  void field(const std::string& key, int& value, Range range, const std::string& help);
  void field(const std::string& key, double& value, Range range, const std::string& help);
  void field(const std::string& key, std::string& value, const std::string& help);
  /// A string out of a fixed set.
  void choice(const std::string& key, std::string& value, std::vector<std::string> allowed, const std::string& help);
  void field(const std::string& key, std::vector<std::string>& value, const std::string& help);
  void field(const std::string& key, std::map<std::string, std::string>& value, const std::string& help);

  /// Binds a nested struct under `prefix.`.
  template <class Struct>
  void section(const std::string& prefix, Struct& nested) {
    const std::string saved = prefix_;
    prefix_ += prefix + ".";
    nested.bind(*this);
    prefix_ = saved;
  }

  /// Loads a YAML file. Top-level sections named in `foreign_sections` belong to other services and are skipped, unless
  /// a key of this binder lies in them; any other unknown key, a wrong type or a value out of range throws ConfigError.
  void load_file(const std::string& path, const std::vector<std::string>& foreign_sections);
  /// The same for YAML text; errors name `origin`.
  void load_text(const std::string& yaml, const std::string& origin, const std::vector<std::string>& foreign_sections);
  /// Applies one "key=value" override (value parsed as YAML). With `foreign_sections`, a key of another service is
  /// skipped.
  void set(const std::string& assignment, const std::vector<std::string>& foreign_sections = {});
  /// Applies already parsed `key` and YAML text `value`.
  void set(const std::string& key, const std::string& yaml_value, const std::string& origin);
  /// All keys with the values in force, as YAML.
  std::string print() const;
  std::vector<std::string> keys() const;

 private:
  struct Entry {
    std::string key, help;
    std::function<void(const std::string& yaml, const std::string& origin)> assign;
    std::function<std::string()> to_yaml;
  };
  void add(const std::string& key, const std::string& help,
           std::function<void(const std::string&, const std::string&)> assign, std::function<std::string()> to_yaml);
  Entry* find(const std::string& key);
  bool is_foreign(const std::string& key, const std::vector<std::string>& foreign_sections) const;
  [[noreturn]] void throw_unknown(const std::string& key, const std::string& origin) const;

  std::string prefix_;
  std::vector<Entry> entries_;
};

/// The candidate with the smallest edit distance to `word`; empty when none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace rtd::service
