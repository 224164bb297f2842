// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/config.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

namespace rtd::service {
namespace {

[[noreturn]] void throw_bad_value(const std::string& key, const std::string& yaml, const std::string& wanted,
                                  const std::string& origin) {
  throw ConfigError(fmt::format("{}: {} = {} is not allowed: use {}", origin, key, yaml, wanted));
}

std::string describe(Range range, const char* kind) {
  const bool has_min = range.min > std::numeric_limits<double>::lowest(),
             has_max = range.max < std::numeric_limits<double>::max();
  if (has_min && has_max) return fmt::format("{} from {:g} to {:g}", kind, range.min, range.max);
  if (has_min) return fmt::format("{} of at least {:g}", kind, range.min);
  if (has_max) return fmt::format("{} of at most {:g}", kind, range.max);
  return kind;
}

template <class T>
T parse(const std::string& key, const std::string& yaml, const std::string& wanted, const std::string& origin) {
  try {
    return YAML::Load(yaml).as<T>();
  } catch (const YAML::Exception&) {
    throw_bad_value(key, yaml, wanted, origin);
  }
}

template <class T>
std::string dump(const T& value) {
  YAML::Emitter emitter;
  emitter.SetSeqFormat(YAML::Flow);
  emitter.SetMapFormat(YAML::Flow);
  emitter << value;
  return emitter.c_str();
}

std::string dump_node(const YAML::Node& node) {
  YAML::Emitter emitter;
  emitter.SetSeqFormat(YAML::Flow);
  emitter.SetMapFormat(YAML::Flow);
  emitter << node;
  return emitter.c_str();
}

std::string section_of(const std::string& key) {
  return key.substr(0, key.find('.'));
}

int edit_distance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  int best_distance = static_cast<int>(std::max<std::size_t>(2, word.size() / 3)) + 1;
  for (const std::string& candidate : candidates) {
    const int distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

void ConfigBinder::add(const std::string& key, const std::string& help,
                       std::function<void(const std::string&, const std::string&)> assign,
                       std::function<std::string()> to_yaml) {
  entries_.push_back({prefix_ + key, help, std::move(assign), std::move(to_yaml)});
}

void ConfigBinder::field(const std::string& key, bool& value, const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, full](const std::string& yaml, const std::string& origin) {
        value = parse<bool>(full, yaml, "true or false", origin);
      },
      [&value] { return value ? "true" : "false"; });
}

void ConfigBinder::field(const std::string& key, int& value, Range range, const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, range, full](const std::string& yaml, const std::string& origin) {
        const std::string wanted = describe(range, "a whole number");
        const int parsed = parse<int>(full, yaml, wanted, origin);
        if (parsed < range.min || parsed > range.max) throw_bad_value(full, yaml, wanted, origin);
        value = parsed;
      },
      [&value] { return std::to_string(value); });
}

void ConfigBinder::field(const std::string& key, double& value, Range range, const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, range, full](const std::string& yaml, const std::string& origin) {
        const std::string wanted = describe(range, "a number");
        const double parsed = parse<double>(full, yaml, wanted, origin);
        if (!std::isfinite(parsed) || parsed < range.min || parsed > range.max)
          throw_bad_value(full, yaml, wanted, origin);
        value = parsed;
      },
      [&value] { return fmt::format("{:g}", value); });
}

void ConfigBinder::field(const std::string& key, std::string& value, const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, full](const std::string& yaml, const std::string& origin) {
        value = parse<std::string>(full, yaml, "a text", origin);
      },
      [&value] { return dump(value); });
}

void ConfigBinder::choice(const std::string& key, std::string& value, std::vector<std::string> allowed,
                          const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, full, allowed = std::move(allowed)](const std::string& yaml, const std::string& origin) {
        const std::string wanted = fmt::format("one of {}", fmt::join(allowed, ", "));
        // YAML 1.1 reads a bare `off` as a boolean; a choice takes the text as written.
        const std::string parsed = parse<std::string>(full, yaml, wanted, origin);
        if (std::find(allowed.begin(), allowed.end(), parsed) == allowed.end())
          throw_bad_value(full, yaml, wanted, origin);
        value = parsed;
      },
      [&value] { return dump(value); });
}

void ConfigBinder::field(const std::string& key, std::vector<std::string>& value, const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, full](const std::string& yaml, const std::string& origin) {
        value = parse<std::vector<std::string>>(full, yaml, "a list such as [a, b]", origin);
      },
      [&value] { return dump(value); });
}

void ConfigBinder::field(const std::string& key, std::map<std::string, std::string>& value, const std::string& help) {
  const std::string full = prefix_ + key;
  add(
      key, help,
      [&value, full](const std::string& yaml, const std::string& origin) {
        value = parse<std::map<std::string, std::string>>(full, yaml, "a map such as {person: high}", origin);
      },
      [&value] { return dump(value); });
}

ConfigBinder::Entry* ConfigBinder::find(const std::string& key) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.key == key; });
  return found == entries_.end() ? nullptr : &*found;
}

/// In a foreign section that holds no key of ours: a typo in our own section stays an error.
bool ConfigBinder::is_foreign(const std::string& key, const std::vector<std::string>& foreign_sections) const {
  const std::string section = section_of(key);
  const bool own = std::any_of(entries_.begin(), entries_.end(),
                               [&](const Entry& entry) { return section_of(entry.key) == section; });
  return !own && std::find(foreign_sections.begin(), foreign_sections.end(), section) != foreign_sections.end();
}

std::vector<std::string> ConfigBinder::keys() const {
  std::vector<std::string> result;
  result.reserve(entries_.size());
  for (const Entry& entry : entries_) result.push_back(entry.key);
  return result;
}

void ConfigBinder::throw_unknown(const std::string& key, const std::string& origin) const {
  const std::string near = nearest_word(key, keys());
  throw ConfigError(
      fmt::format("{}: unknown key '{}'{}", origin, key,
                  near.empty() ? ": see --print-config for all keys" : fmt::format(", did you mean '{}'?", near)));
}

void ConfigBinder::set(const std::string& key, const std::string& yaml_value, const std::string& origin) {
  Entry* entry = find(key);
  if (entry == nullptr) throw_unknown(key, origin);
  entry->assign(yaml_value, origin);
}

void ConfigBinder::set(const std::string& assignment, const std::vector<std::string>& foreign_sections) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ConfigError(fmt::format("--set {}: write key=value, for example --set filter.mode=rtd", assignment));
  }
  const std::string key = assignment.substr(0, equals);
  if (is_foreign(key, foreign_sections)) return;
  set(key, assignment.substr(equals + 1), "--set");
}

namespace {

/// Calls visit(key, yaml) for every node that is a known key or a leaf, with sections joined by dots.
void flatten(const YAML::Node& node, const std::string& prefix, const std::vector<std::string>& known,
             const std::function<void(const std::string&, const std::string&)>& visit) {
  for (const auto& child : node) {
    const std::string key = prefix + child.first.as<std::string>();
    const bool is_key = std::find(known.begin(), known.end(), key) != known.end();
    if (child.second.IsMap() && !is_key) {
      flatten(child.second, key + ".", known, visit);
    } else {
      visit(key, dump_node(child.second));
    }
  }
}

}  // namespace

void ConfigBinder::load_file(const std::string& path, const std::vector<std::string>& foreign_sections) {
  std::ifstream file(path);
  if (!file) throw ConfigError(fmt::format("config file '{}' cannot be read: check the path given to --config", path));
  load_text({std::istreambuf_iterator<char>(file), {}}, path, foreign_sections);
}

void ConfigBinder::load_text(const std::string& yaml, const std::string& origin,
                             const std::vector<std::string>& foreign_sections) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(fmt::format("{}:{}: not valid YAML: {}", origin, error.mark.line + 1, error.msg));
  }
  if (root.IsNull()) return;
  if (!root.IsMap()) throw ConfigError(fmt::format("{}: expected sections such as 'filter:' at the top level", origin));
  flatten(root, "", keys(), [&](const std::string& key, const std::string& value) {
    if (is_foreign(key, foreign_sections)) return;
    set(key, value, origin);
  });
}

std::string ConfigBinder::print() const {
  std::string out;
  std::vector<std::string> open;
  for (const Entry& entry : entries_) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0, dot = 0; dot != std::string::npos; begin = dot + 1) {
      dot = entry.key.find('.', begin);
      parts.push_back(entry.key.substr(begin, dot == std::string::npos ? dot : dot - begin));
    }
    const std::string leaf = parts.back();
    parts.pop_back();
    std::size_t common = 0;
    while (common < std::min(open.size(), parts.size()) && open[common] == parts[common]) ++common;
    for (std::size_t i = common; i < parts.size(); ++i) out += fmt::format("{:{}}{}:\n", "", 2 * i, parts[i]);
    open = parts;
    out += fmt::format("{:{}}{}: {}  # {}\n", "", 2 * parts.size(), leaf, entry.to_yaml(), entry.help);
  }
  return out;
}

}  // namespace rtd::service
