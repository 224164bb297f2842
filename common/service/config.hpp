// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

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

/// An option of the command line that was given: the value of a key.
struct GivenOption {
  std::string key;                 ///< "slam.map.load"
  std::string flag;                ///< "--map": its first long name
  std::vector<std::string> words;  ///< one; of a list each of its values; of a switch "true" or "false"
};

/// Reads, checks and prints the settings of plain config structs, and makes options of the command line of them.
///
/// How a struct describes its settings, each in one place: the member has the default, and `bind`, right below the
/// members, has key, range, help text and option. The members then need no comments. `bind` is a template so that the
/// header of a core needs nothing of this one, and it costs nothing where it is not called:
///
///   struct FusionConfig {
///     double voxel_m = 0.02;
///     bool unknown_is_static = false;
///     NoiseConfig noise;
///
///     void bind(auto& binder) {
///       binder.field("voxel_m", voxel_m, {0.002, 1.0}, "side length of a voxel").option("--voxel");
///       binder.field("unknown_is_static", unknown_is_static, "also fuse what the filter could not judge");
///       binder.section("noise", noise);  // keys `noise.*`
///     }
///   };
///
/// Bound settings must outlive the binder. Not thread-safe.
class ConfigBinder {
  struct Setting;

 public:
  /// A setting that was just bound.
  class Bound {
   public:
    explicit Bound(Setting& setting) : setting_(setting) {}
    /// It is an option of the command line, too. `flags`: "--map", or several such as "-r,--rate"; without dashes it is
    /// the argument without a name. `group`: under which `rtd run --help` lists it.
    void option(std::string_view flags, std::string_view group = "");
    /// The full key that it had in the last version, which is still read.
    Bound formerly(std::string_view key);

   private:
    Setting& setting_;
  };

  ConfigBinder();
  ~ConfigBinder();
  ConfigBinder(const ConfigBinder&) = delete;
  ConfigBinder& operator=(const ConfigBinder&) = delete;

  Bound field(std::string_view key, bool& value, std::string_view help);
  Bound field(std::string_view key, int& value, Range range, std::string_view help);
  Bound field(std::string_view key, std::uint32_t& value, Range range, std::string_view help);
  Bound field(std::string_view key, double& value, Range range, std::string_view help);
  Bound field(std::string_view key, std::string& value, std::string_view help);
  Bound field(std::string_view key, std::vector<std::string>& value, std::string_view help);
  Bound field(std::string_view key, std::map<std::string, std::string>& value, std::string_view help);
  /// A string out of a fixed set. `former`: names of earlier versions, each read as the name that it has now.
  Bound choice(std::string_view key, std::string& value, std::vector<std::string> allowed, std::string_view help,
               std::map<std::string, std::string> former = {});

  /// Binds a nested struct: its keys begin with `prefix.`.
  template <class Struct>
  void section(std::string_view prefix, Struct& nested) {
    nest(prefix, [&nested](ConfigBinder& binder) { nested.bind(binder); });
  }

  /// The same for a part of the settings of another service. The keys of the section that were not bound are that
  /// service's own: they are passed over.
  void part_of_section(std::string_view name, const std::function<void(ConfigBinder&)>& bind);

  /// Adds the options of all settings to a command line. Those that are given are appended to `given`, which must
  /// outlive the parsing; the binder need not. One with an empty value counts as not given.
  void add_options(CLI::App& app, std::vector<GivenOption>& given) const;
  /// Sets the key of an option. Throws ConfigError naming the option for a value that is not allowed.
  void set(const GivenOption& option);

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
  /// Binds settings whose keys begin with `prefix.`.
  void nest(std::string_view prefix, const std::function<void(ConfigBinder&)>& bind);
  template <class T, class Allowed>
  Bound add(std::string_view key, T& value, std::string wanted, Allowed allowed, std::string_view help);
  Setting* find(const std::string& key);
  std::vector<std::string> keys() const;
  bool is_of_others(const std::string& key, const std::vector<std::string>& other_sections) const;

  std::string prefix_;
  std::vector<Setting> settings_;  ///< those of a section next to each other
  std::vector<std::string> in_part_;
};

/// The command line that gives another process the options of `given` whose keys lie in a section, except some keys.
std::vector<std::string> to_command_line(const std::vector<GivenOption>& given, const std::string& section,
                                         const std::vector<std::string>& without = {});

}  // namespace rtd::service
