// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::service {

struct ConfigBinder::Setting {
  std::string key, help;
  std::string wanted;                                               ///< "a number from 1 to 5"
  std::function<bool(const std::string& yaml)> read;                ///< false: this is not what is wanted
  std::function<bool(const std::vector<std::string>& words)> take;  ///< the same for words of a command line
  std::function<std::string()> print;
  std::string former = {};             ///< key of the last version
  std::string type = {};               ///< of its value, as help shows it: "INT"
  std::string flags = {}, group = {};  ///< of its option; "": none
  bool is_switch = false, is_list = false;
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

/// How many sections two keys have in common: 2 of "slam.map.load" and "slam.map.save".
std::ptrdiff_t common_sections(const std::string& a, const std::string& b) {
  const auto [end, ignored] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return std::count(a.begin(), end, '.');
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
                                      origin_, io::abridged(prefix)));
      if (!child.first.IsScalar())
        throw ConfigError(
            fmt::format("{}: a key below '{}' is not a name: write 'key: value'", origin_, io::abridged(prefix)));
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

ConfigBinder::ConfigBinder() = default;
ConfigBinder::~ConfigBinder() = default;

template <class T, class Allowed>
ConfigBinder::Bound ConfigBinder::add(std::string_view key, T& value, std::string wanted, Allowed allowed,
                                      std::string_view help) {
  const auto assign = [&value, allowed = std::move(allowed)](T parsed) {
    if (!allowed(parsed)) return false;
    value = std::move(parsed);
    return true;
  };
  const auto read = [assign](const std::string& yaml) {
    try {
      return assign(YAML::Load(yaml).as<T>());
    } catch (const YAML::Exception&) {
      return false;
    }
  };
  constexpr bool kList = std::is_same_v<T, std::vector<std::string>>;
  const auto take = [=](const std::vector<std::string>& words) {
    if constexpr (kList) {
      return assign(words);
    } else if constexpr (std::is_same_v<T, std::string>) {
      return assign(words.back());
    } else {
      return read(words.back());
    }
  };
  const std::string path = prefix_ + std::string(key);
  const auto near = [&path](const Setting& setting) { return common_sections(setting.key, path); };
  const auto beside = std::max_element(settings_.rbegin(), settings_.rend(),
                                       [&](const Setting& a, const Setting& b) { return near(a) < near(b); });
  const bool alone = beside == settings_.rend() || near(*beside) == 0;
  const auto added = settings_.insert(
      alone ? settings_.end() : beside.base(),
      {path, std::string(help), std::move(wanted), read, take, [&value] { return print_value(value); }});
  added->type = std::is_floating_point_v<T> ? "FLOAT" : std::is_arithmetic_v<T> ? "INT" : "TEXT";
  added->is_switch = std::is_same_v<T, bool>;
  added->is_list = kList;
  return Bound(*added);
}

void ConfigBinder::Bound::option(std::string_view flags, std::string_view group) {
  setting_.flags = flags;
  setting_.group = group;
}

ConfigBinder::Bound ConfigBinder::Bound::formerly(std::string_view key) {
  setting_.former = key;
  return *this;
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, bool& value, std::string_view help) {
  return add(key, value, "true or false", anything<bool>, help);
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, int& value, Range range, std::string_view help) {
  return add(key, value, wanted_number(range, "a whole number"), within(range), help);
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, std::uint32_t& value, Range range,
                                        std::string_view help) {
  return add(key, value, wanted_number(range, "a whole number"), within(range), help);
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, double& value, Range range, std::string_view help) {
  return add(key, value, wanted_number(range, "a number"), within(range), help);
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, std::string& value, std::string_view help) {
  return add(key, value, "a text", anything<std::string>, help);
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, std::vector<std::string>& value, std::string_view help) {
  return add(key, value, "a list such as [a, b]", anything<std::vector<std::string>>, help);
}

ConfigBinder::Bound ConfigBinder::field(std::string_view key, std::map<std::string, std::string>& value,
                                        std::string_view help) {
  return add(key, value, "a map such as {person: high}", anything<std::map<std::string, std::string>>, help);
}

/// YAML 1.1 reads a bare `off` as a boolean; a choice takes the text as written.
ConfigBinder::Bound ConfigBinder::choice(std::string_view key, std::string& value, std::vector<std::string> allowed,
                                         std::string_view help, std::map<std::string, std::string> former) {
  const std::string wanted = fmt::format("one of {}", fmt::join(allowed, ", "));
  const std::string type = fmt::format("TEXT:{{{}}}", fmt::join(allowed, ","));
  const auto listed = [allowed = std::move(allowed), former = std::move(former)](std::string& text) {
    if (const auto renamed = former.find(text); renamed != former.end()) text = renamed->second;
    return std::find(allowed.begin(), allowed.end(), text) != allowed.end();
  };
  const Bound bound = add(key, value, wanted, listed, help);
  find(prefix_ + std::string(key))->type = type;
  return bound;
}

/// A section of another service holds no key of this binder: a typo in an own section stays an error.
bool ConfigBinder::is_of_others(const std::string& key, const std::vector<std::string>& other_sections) const {
  const std::string section = section_of(key);
  if (std::ranges::count(in_part_, section) > 0) {
    return std::ranges::none_of(
        settings_, [&](const Setting& setting) { return setting.key == key || setting.key.starts_with(key + '.'); });
  }
  const bool own = std::any_of(settings_.begin(), settings_.end(),
                               [&](const Setting& setting) { return section_of(setting.key) == section; });
  return !own && std::find(other_sections.begin(), other_sections.end(), section) != other_sections.end();
}

std::vector<std::string> ConfigBinder::keys() const {
  std::vector<std::string> result;
  for (const Setting& setting : settings_) result.push_back(setting.key);
  return result;
}

void ConfigBinder::part_of_section(std::string_view name, const std::function<void(ConfigBinder&)>& bind) {
  in_part_.emplace_back(name);
  nest(name, bind);
}

void ConfigBinder::nest(std::string_view prefix, const std::function<void(ConfigBinder&)>& bind) {
  const std::string outer = prefix_;
  prefix_.append(prefix).append(".");
  bind(*this);
  prefix_ = outer;
}

ConfigBinder::Setting* ConfigBinder::find(const std::string& key) {
  const auto setting = std::ranges::find_if(
      settings_, [&](const Setting& known) { return known.key == key || (known.former == key && !key.empty()); });
  return setting == settings_.end() ? nullptr : &*setting;
}

void ConfigBinder::set(const std::string& key, const std::string& yaml_value, const std::string& origin) {
  const Setting* const setting = find(key);
  if (setting == nullptr) {
    const std::string near = io::nearest_name(key, keys());
    throw ConfigError(
        fmt::format("{}: unknown key '{}'{}", origin, io::abridged(key),
                    near.empty() ? ": see --print-config for all keys" : fmt::format(", did you mean '{}'?", near)));
  }
  if (!setting->read(yaml_value))
    throw ConfigError(
        fmt::format("{}: {} = {} is not allowed: use {}", origin, key, io::abridged(yaml_value), setting->wanted));
}

void ConfigBinder::set(const GivenOption& option) {
  const Setting* const setting = find(option.key);
  if (setting == nullptr || !setting->take(option.words))
    throw ConfigError(fmt::format("{} {} is not allowed: use {}", option.flag,
                                  io::abridged(fmt::format("{}", fmt::join(option.words, ","))),
                                  setting == nullptr ? "another option" : setting->wanted));
}

void ConfigBinder::set(const std::string& assignment, const std::vector<std::string>& other_sections) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ConfigError(
        fmt::format("--set {}: write key=value, for example --set filter.mode=rtd", io::abridged(assignment)));
  }
  const std::string key = assignment.substr(0, equals);
  if (!is_of_others(key, other_sections)) set(key, assignment.substr(equals + 1), "--set");
}

void ConfigBinder::load_file(const std::string& path, const std::vector<std::string>& other_sections) {
  try {
    load_text(io::read_file(path, io::kSettings), path, other_sections);
  } catch (const io::IoError& error) {
    throw ConfigError(fmt::format("--config {}", error.what()));
  }
}

void ConfigBinder::load_text(const std::string& yaml, const std::string& origin,
                             const std::vector<std::string>& other_sections) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(fmt::format("{}:{}: not valid YAML: {}", origin, error.mark.line + 1, io::abridged(error.msg)));
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
    const std::string option = setting.flags.starts_with('-') ? fmt::format(" ({})", setting.flags) : "";
    out += fmt::format("{:{}}{}: {}  # {}{}\n", "", 2 * sections.size(), leaf, setting.print(), setting.help, option);
    open = std::move(sections);
  }
  return out;
}

namespace {

/// What `--help` shows of a default, one word: nothing of a switch that is off, an empty text or list.
std::string shown_default(std::string printed) {
  std::erase(printed, ' ');
  return printed == "false" || printed == "\"\"" || printed == "[]" ? "" : printed;
}

/// "--rate" of "-r,--rate".
std::string first_long_name(const std::string& flags) {
  const std::size_t begin = flags.find("--");
  return begin == std::string::npos ? flags : flags.substr(begin, flags.find(',', begin) - begin);
}

}  // namespace

void ConfigBinder::add_options(CLI::App& app, std::vector<GivenOption>& given) const {
  for (const Setting& setting : settings_) {
    if (setting.flags.empty()) continue;
    std::string help = fmt::format("{} ({})", setting.help, setting.key);
    help.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(help.front())));
    const auto keep = [&given, key = setting.key,
                       flag = first_long_name(setting.flags)](std::vector<std::string> words) {
      if (words != std::vector<std::string>{""}) given.push_back({key, flag, std::move(words)});
    };
    CLI::Option* option = nullptr;
    if (setting.is_switch) {
      option = app.add_flag_function(
          setting.flags, [keep](std::int64_t count) { keep({count > 0 ? "true" : "false"}); }, help);
    } else if (setting.is_list) {
      option = app.add_option_function<std::vector<std::string>>(setting.flags, keep, help)->delimiter(',');
    } else {
      option = app.add_option_function<std::string>(
          setting.flags, [keep](const std::string& word) { keep({word}); }, help);
      option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)->type_name(setting.type);
    }
    if (const std::string value = shown_default(setting.print()); !value.empty()) option->default_str(value);
    if (!setting.group.empty()) option->group(setting.group);
  }
}

std::vector<std::string> to_command_line(const std::vector<GivenOption>& given, const std::string& section,
                                         const std::vector<std::string>& without) {
  std::vector<std::string> line;
  for (const GivenOption& option : given) {
    if (section_of(option.key) != section || std::ranges::count(without, option.key) > 0) continue;
    line.push_back(fmt::format("{}={}", option.flag, fmt::join(option.words, ",")));
  }
  return line;
}

}  // namespace rtd::service
