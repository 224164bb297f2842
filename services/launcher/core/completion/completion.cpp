// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/completion/completion.hpp"

#include <algorithm>
#include <regex>
#include <sstream>

namespace rtd::launcher {
namespace {

/// An option as its help names it.
struct HelpOption {
  std::string name;  ///< "--pace"
  bool takes_value = false;
  std::vector<std::string> values;  ///< that it may have; empty: any
  std::string text;
};

/// The help of a program: "  --pace TEXT:{realtime,asap}=realtime  what it does", or the text on the lines that follow.
class Help {
 public:
  explicit Help(const std::string& text) {
    static const std::regex option(R"(^  (?:-\w,)?(--[\w-]+)(?:,--[\w-]+)*(?: (\S+)(?: \.\.\.)?(?: REQUIRED)?)?(?:  +(.*))?$)");
    static const std::regex subcommand(R"(^  ([a-z][\w-]*)  +\S.*$)");
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::smatch found;
      if (std::regex_match(line, found, option)) {
        options_.push_back({found[1], found[2].matched, values_of(found[2]), found[3]});
      } else if (std::regex_match(line, found, subcommand)) {
        subcommands_.push_back(found[1]);
      } else if (!options_.empty() && line.starts_with("      ")) {
        options_.back().text += line;
      }
    }
  }
  const std::vector<HelpOption>& options() const { return options_; }
  const std::vector<std::string>& subcommands() const { return subcommands_; }
  const HelpOption* option(const std::string& name) const {
    const auto found = std::ranges::find(options_, name, &HelpOption::name);
    return found == options_.end() ? nullptr : &*found;
  }

 private:
  static std::vector<std::string> values_of(const std::string& type) {
    const std::size_t first = type.find('{'), last = type.find('}');
    std::vector<std::string> values;
    if (first == std::string::npos || last == std::string::npos) return values;
    std::istringstream list(type.substr(first + 1, last - first - 1));
    for (std::string value; std::getline(list, value, ',');) values.push_back(value);
    return values;
  }

  std::vector<HelpOption> options_;
  std::vector<std::string> subcommands_;
};

/// "tum:", "bag:", ... of the text "tum:FOLDER, bag:FILE or ros2:COLOR".
std::vector<std::string> schemes_in(const std::string& text) {
  static const std::regex scheme(R"((^|[ ,])([a-z][a-z0-9-]*:)(?=[A-Z\[]))");
  std::vector<std::string> schemes;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), scheme); it != std::sregex_iterator(); ++it)
    schemes.push_back((*it)[2]);
  return schemes;
}

/// "slam.base.frame=" of each value of the YAML text.
std::vector<std::string> keys_in(const std::string& yaml) {
  static const std::regex entry(R"(^( *)([\w.]+):(.*)$)");
  std::vector<std::string> keys, path;
  std::istringstream lines(yaml);
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (!std::regex_match(line, found, entry)) continue;
    path.resize(std::min(path.size(), static_cast<std::size_t>(found[1].length()) / 2));
    path.push_back(found[2]);
    const std::string value = found[3];
    if (value.find_first_not_of(' ') == std::string::npos || value.find_first_not_of(' ') == value.find('#')) continue;
    std::string key;
    for (const std::string& part : path) key += (key.empty() ? "" : ".") + part;
    keys.push_back(key + '=');
  }
  return keys;
}

std::vector<std::string> keys_for(const std::string& command, const CompletionSources& sources) {
  if (command != "run") return keys_in(sources.config(command));
  std::vector<std::string> keys;
  for (const std::string& service : sources.services) {
    for (std::string& key : keys_in(sources.config(service)))
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(std::move(key));  // bus is in all of them
  }
  return keys;
}

std::vector<std::string> values_for(const HelpOption& option, const std::string& command,
                                    const CompletionSources& sources) {
  if (option.name == "--set") return keys_for(command, sources);
  if (option.name == "--source") return schemes_in(option.text);
  return option.values;
}

}  // namespace

std::vector<std::string> complete(const std::vector<std::string>& words, const CompletionSources& sources) {
  const std::string last = words.empty() ? "" : words.back();
  std::vector<std::string> candidates;
  if (words.size() < 2) {
    candidates = sources.commands;
  } else {
    std::vector<std::string> command = {words[0]};
    Help help(sources.help(command));
    if (words.size() > 2 && std::ranges::find(help.subcommands(), words[1]) != help.subcommands().end()) {
      command.push_back(words[1]);
      help = Help(sources.help(command));
    }
    const HelpOption* const before = help.option(words[words.size() - 2]);
    if (before != nullptr && before->takes_value) {
      candidates = values_for(*before, command.front(), sources);
    } else if (last.starts_with('-')) {
      for (const HelpOption& option : help.options()) candidates.push_back(option.name);
    } else if (command.front() == "topics" && command.size() > 1) {
      candidates = sources.topics;
    } else {
      candidates = help.subcommands();
    }
  }
  std::erase_if(candidates, [&](const std::string& candidate) { return !candidate.starts_with(last); });
  return candidates;
}

}  // namespace rtd::launcher
