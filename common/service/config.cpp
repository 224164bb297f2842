// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/config.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "common/io/text.hpp"

namespace rtd::service {

struct ConfigBinder::Setting {
  std::string key, help;
  std::string wanted;                                 ///< "a number from 1 to 5"
  std::function<bool(const std::string& yaml)> read;  ///< false: this is not what is wanted
  std::function<std::string()> print;
};

namespace {

std::string wanted_number(Range range, const char* kind) {
  const bool has_min = range.min > std::numeric_limits<double>::lowest(),
             has_max = range.max < std::numeric_limits<double>::max();
  if (has_min && has_max) return fmt::format("{} from {:g} to {:g}", kind, range.min, range.max);
  if (has_min) return fmt::format("{} of at least {:g}", kind, range.min);
  if (has_max) return fmt::format("{} of at most {:g}", kind, range.max);
  return kind;
}

auto within(Range range) {
  return [range](auto number) {
    return std::isfinite(static_cast<double>(number)) && number >= range.min && number <= range.max;
  };
}

bool anything(const auto&) {
  return true;
}

template <class T>
std::string dump(const T& value) {
  YAML::Emitter emitter;
  emitter.SetSeqFormat(YAML::Flow);
  emitter.SetMapFormat(YAML::Flow);
  emitter << value;
  return emitter.c_str();
}

std::string print_value(double value) {
  return fmt::format("{:g}", value);
}

template <class T>
std::string print_value(const T& value) {
  return dump(value);
}

std::string section_of(const std::string& key) {
  return key.substr(0, key.find('.'));
}

/// Walks through the sections of a file. Anchors let a short text hold itself, or itself many times: both are bounded.
class Flattener {
 public:
  /// `known`: keys, what is below them is their value. `skips`: keys and sections that are passed over.
  Flattener(std::vector<std::string> known, std::string origin, std::function<bool(const std::string& key)> skips)
      : known_(std::move(known)), origin_(std::move(origin)), skips_(std::move(skips)) {}

  /// Calls visit(key, yaml) for every node that is a known key or a leaf, with sections joined by dots.
  void flatten(const YAML::Node& node, const std::string& prefix, int depth,
               const std::function<void(const std::string&, const std::string&)>& visit) {
    constexpr int kDeepest = 16, kMaxNodes = 100'000;
    for (const auto& child : node) {
      if (depth >= kDeepest || ++nodes_ > kMaxNodes)
        throw ConfigError(fmt::format("{}: section '{}' has too many sections within it: remove anchors and aliases",
                                      origin_, prefix.substr(0, 60)));
      if (!child.first.IsScalar())
        throw ConfigError(fmt::format("{}: a key below '{}' is not a name: write 'key: value'", origin_, prefix));
      const std::string key = prefix + child.first.Scalar();
      if (skips_(key)) continue;
      const bool is_key = std::find(known_.begin(), known_.end(), key) != known_.end();
      if (child.second.IsMap() && !is_key) {
        flatten(child.second, key + ".", depth + 1, visit);
      } else {
        visit(key, dump(child.second));
      }
    }
  }

 private:
  const std::vector<std::string> known_;
  const std::string origin_;
  const std::function<bool(const std::string& key)> skips_;
  int nodes_ = 0;
};

std::vector<std::string> split_at_dots(const std::string& key) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0, dot = 0; dot != std::string::npos; begin = dot + 1) {
    dot = key.find('.', begin);
    parts.push_back(key.substr(begin, dot == std::string::npos ? dot : dot - begin));
  }
  return parts;
}

}  // namespace

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  return io::nearest_name(name, candidates);
}

ConfigBinder::ConfigBinder() = default;
ConfigBinder::~ConfigBinder() = default;

template <class T, class Allowed>
void ConfigBinder::add(std::string_view key, T& value, std::string wanted, Allowed allowed, std::string_view help) {
  const auto read = [&value, allowed = std::move(allowed)](const std::string& yaml) {
    try {
      T parsed = YAML::Load(yaml).as<T>();
      if (!allowed(parsed)) return false;
      value = std::move(parsed);
      return true;
    } catch (const YAML::Exception&) {
      return false;
    }
  };
  settings_.push_back({prefix_ + std::string(key), std::string(help), std::move(wanted), read,
                       [&value] { return print_value(value); }});
}

void ConfigBinder::field(std::string_view key, bool& value, std::string_view help) {
  add(key, value, "true or false", anything<bool>, help);
}

void ConfigBinder::field(std::string_view key, int& value, Range range, std::string_view help) {
  add(key, value, wanted_number(range, "a whole number"), within(range), help);
}

void ConfigBinder::field(std::string_view key, std::uint32_t& value, Range range, std::string_view help) {
  add(key, value, wanted_number(range, "a whole number"), within(range), help);
}

void ConfigBinder::field(std::string_view key, double& value, Range range, std::string_view help) {
  add(key, value, wanted_number(range, "a number"), within(range), help);
}

void ConfigBinder::field(std::string_view key, std::string& value, std::string_view help) {
  add(key, value, "a text", anything<std::string>, help);
}

void ConfigBinder::field(std::string_view key, std::vector<std::string>& value, std::string_view help) {
  add(key, value, "a list such as [a, b]", anything<std::vector<std::string>>, help);
}

void ConfigBinder::field(std::string_view key, std::map<std::string, std::string>& value, std::string_view help) {
  add(key, value, "a map such as {person: high}", anything<std::map<std::string, std::string>>, help);
}

/// YAML 1.1 reads a bare `off` as a boolean; a choice takes the text as written.
void ConfigBinder::choice(std::string_view key, std::string& value, std::vector<std::string> allowed,
                          std::string_view help, std::map<std::string, std::string> former) {
  const std::string wanted = fmt::format("one of {}", fmt::join(allowed, ", "));
  const auto listed = [allowed = std::move(allowed), former = std::move(former)](std::string& text) {
    if (const auto renamed = former.find(text); renamed != former.end()) text = renamed->second;
    return std::find(allowed.begin(), allowed.end(), text) != allowed.end();
  };
  add(key, value, wanted, listed, help);
}

/// A section of another service holds no key of this binder: a typo in an own section stays an error.
bool ConfigBinder::is_of_others(const std::string& key, const std::vector<std::string>& other_sections) const {
  const std::string section = section_of(key);
  const bool own = std::any_of(settings_.begin(), settings_.end(),
                               [&](const Setting& setting) { return section_of(setting.key) == section; });
  return !own && std::find(other_sections.begin(), other_sections.end(), section) != other_sections.end();
}

std::vector<std::string> ConfigBinder::keys() const {
  std::vector<std::string> result;
  for (const Setting& setting : settings_) result.push_back(setting.key);
  return result;
}

void ConfigBinder::set(const std::string& key, const std::string& yaml_value, const std::string& origin) {
  const auto setting =
      std::find_if(settings_.begin(), settings_.end(), [&](const Setting& known) { return known.key == key; });
  if (setting == settings_.end()) {
    const std::string near = nearest_name(key, keys());
    throw ConfigError(
        fmt::format("{}: unknown key '{}'{}", origin, key,
                    near.empty() ? ": see --print-config for all keys" : fmt::format(", did you mean '{}'?", near)));
  }
  if (!setting->read(yaml_value))
    throw ConfigError(fmt::format("{}: {} = {} is not allowed: use {}", origin, key, yaml_value, setting->wanted));
}

void ConfigBinder::set(const std::string& assignment, const std::vector<std::string>& other_sections) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ConfigError(fmt::format("--set {}: write key=value, for example --set filter.mode=rtd", assignment));
  }
  const std::string key = assignment.substr(0, equals);
  if (!is_of_others(key, other_sections)) set(key, assignment.substr(equals + 1), "--set");
}

void ConfigBinder::load_file(const std::string& path, const std::vector<std::string>& other_sections) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable))
    throw ConfigError(fmt::format("config file '{}' is a folder: name a file in it with --config", path));
  std::ifstream file(path);
  if (!file) throw ConfigError(fmt::format("config file '{}' cannot be read: check the path given to --config", path));
  load_text({std::istreambuf_iterator<char>(file), {}}, path, other_sections);
}

void ConfigBinder::load_text(const std::string& yaml, const std::string& origin,
                             const std::vector<std::string>& other_sections) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(fmt::format("{}:{}: not valid YAML: {}", origin, error.mark.line + 1, error.msg));
  }
  if (root.IsNull()) return;
  if (!root.IsMap()) throw ConfigError(fmt::format("{}: expected sections such as 'filter:' at the top level", origin));
  Flattener(keys(), origin, [&](const std::string& key) {
    return is_of_others(key, other_sections);
  }).flatten(root, "", 0, [&](const std::string& key, const std::string& value) { set(key, value, origin); });
}

std::string ConfigBinder::print() const {
  std::string out;
  std::vector<std::string> open;
  for (const Setting& setting : settings_) {
    std::vector<std::string> sections = split_at_dots(setting.key);
    const std::string leaf = sections.back();
    sections.pop_back();
    const auto first_new = std::mismatch(open.begin(), open.end(), sections.begin(), sections.end()).second;
    for (auto section = first_new; section != sections.end(); ++section)
      out += fmt::format("{:{}}{}:\n", "", 2 * (section - sections.begin()), *section);
    out += fmt::format("{:{}}{}: {}  # {}\n", "", 2 * sections.size(), leaf, setting.print(), setting.help);
    open = std::move(sections);
  }
  return out;
}

}  // namespace rtd::service
