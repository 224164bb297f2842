// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/settings_text.hpp"

#include <algorithm>

#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

using Entries = std::map<std::string, SettingsText::Entry>;

constexpr std::string_view kBlank = " \t\r\n";
constexpr std::size_t kMaxDepth = 64;  // of brackets: a file from outside must not exhaust the stack
constexpr std::size_t kMaxPath = 256;  // longer ones are passed over: all that is below repeats them

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::string_view unquoted(std::string_view text) {
  text = trimmed(text);
  const bool quoted = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front();
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// Where a character that `wanted` accepts is outside of quotes; npos when nowhere.
template <class Wanted>
std::size_t outside_quotes(std::string_view text, const Wanted& wanted) {
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quote != 0) {
      if (text[i] == quote) quote = 0;
    } else if (wanted(i)) {
      return i;
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    }
  }
  return std::string_view::npos;
}

std::string_view without_comment(std::string_view line) {
  return line.substr(0, outside_quotes(line, [&](std::size_t i) {
                       return line[i] == '#' && (i == 0 || kBlank.find(line[i - 1]) != std::string_view::npos);
                     }));
}

/// "!!opencv-matrix", "!!float 3" lose their tag.
std::string_view without_tag(std::string_view text) {
  text = trimmed(text);
  if (!text.starts_with('!')) return text;
  const std::size_t end = text.find_first_of(kBlank);
  return end == std::string_view::npos ? std::string_view{} : trimmed(text.substr(end));
}

/// How many brackets are open after parts of a text; a quote may end in a later one.
class BracketCount {
 public:
  int add(std::string_view part) {
    for (const char letter : part) {
      if (quote_ != 0) {
        if (letter == quote_) quote_ = 0;
      } else {
        open_ += letter == '[' || letter == '{';
        open_ -= letter == ']' || letter == '}';
        if (letter == '"' || letter == '\'') quote_ = letter;
      }
    }
    return open_;
  }

 private:
  int open_ = 0;
  char quote_ = 0;
};

/// Cut behind kMaxPath: what is longer is not kept.
std::string joined(const std::string& parent, std::string_view key) {
  std::string path = parent.empty() ? std::string() : parent + ".";
  path.append(key.substr(0, kMaxPath + 1));
  path.resize(std::min(path.size(), kMaxPath + 1));
  return path;
}

void add(Entries& entries, const std::string& path, std::string_view value) {
  if (path.size() > kMaxPath) return;
  SettingsText::Entry& entry = entries.try_emplace(path, SettingsText::Entry{entries.size(), {}}).first->second;
  if (value = unquoted(without_tag(value)); !value.empty()) entry.values.emplace_back(value);
}

/// JSON, and the part of YAML that looks like it.
class FlowReader {
 public:
  FlowReader(std::string_view text, Entries& entries) : text_(text), entries_(entries) {}

  void read(const std::string& path, std::size_t depth = 0) {
    skip_blank();
    if (at_ == text_.size() || depth > kMaxDepth) {
      at_ = text_.size();
    } else if (text_[at_] == '{') {
      read_map(path, depth);
    } else if (text_[at_] == '[') {
      read_list(path, depth);
    } else {
      add(entries_, path, take_until(",]}"));
    }
  }

 private:
  void read_map(const std::string& path, std::size_t depth) {
    ++at_;
    while (!take_end()) {
      const std::string key(unquoted(take_until(":}")));
      if (at_ < text_.size() && text_[at_] == ':') ++at_;
      read(joined(path, key), depth + 1);
    }
  }
  void read_list(const std::string& path, std::size_t depth) {
    ++at_;
    while (!take_end()) read(path, depth + 1);
  }
  /// Passes over blanks and commas; true at the end of the list or map, whichever bracket it has.
  bool take_end() {
    skip_blank();
    while (at_ < text_.size() && text_[at_] == ',') {
      ++at_;
      skip_blank();
    }
    if (at_ == text_.size()) return true;
    if (text_[at_] != ']' && text_[at_] != '}') return false;
    ++at_;
    return true;
  }
  std::string_view take_until(std::string_view ends) {
    const std::string_view rest = text_.substr(at_);
    const std::size_t size = std::min(
        rest.size(), outside_quotes(rest, [&](std::size_t i) { return ends.find(rest[i]) != std::string_view::npos; }));
    at_ += size;
    return rest.substr(0, size);
  }
  void skip_blank() { at_ = std::min(text_.size(), text_.find_first_not_of(kBlank, at_)); }

  std::string_view text_;
  std::size_t at_ = 0;
  Entries& entries_;
};

/// YAML by its indentation, line by line.
class BlockReader {
 public:
  BlockReader(std::string_view text, Entries& entries) : rest_(text), entries_(entries) {}

  void read() {
    while (!rest_.empty()) {
      const std::string_view line = without_comment(take_line());
      const std::size_t indent = line.find_first_not_of(kBlank);
      if (indent == std::string_view::npos || line.starts_with('%') || line.starts_with("---")) continue;
      read_line(trimmed(line), indent);
    }
  }

 private:
  struct Parent {
    std::size_t indent;
    std::string path;
  };

  std::string_view take_line() {
    const std::string_view line = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(std::min(line.size() + 1, rest_.size()));
    return line;
  }

  void read_line(std::string_view content, std::size_t indent) {
    bool item = false;
    for (; content.starts_with("- ") || content == "-"; indent += 2) {
      if (!item) leave(indent + 1);
      item = true;
      content = trimmed(content.substr(1));
    }
    const std::size_t mark = outside_quotes(content, [&](std::size_t i) { return separates(content, i); });
    if (mark == std::string_view::npos) {
      if (item && !parents_.empty()) take_value(parents_.back().path, content);
      return;
    }
    if (!item) leave(indent);
    const std::string path = joined(parents_.empty() ? "" : parents_.back().path, unquoted(content.substr(0, mark)));
    const std::string_view value = without_tag(content.substr(mark + 1));
    value.empty() ? parents_.push_back({indent, path}) : take_value(path, value);
  }

  /// A bracket comes first when the line is a value: the colon in it belongs to a map of its own.
  static bool separates(std::string_view content, std::size_t i) {
    return (content[i] == ':' || content[i] == '=') && !content.starts_with('[') && !content.starts_with('{');
  }

  void leave(std::size_t indent) {
    while (!parents_.empty() && parents_.back().indent >= indent) parents_.pop_back();
  }

  void take_value(const std::string& path, std::string_view value) {
    if (!value.starts_with('[') && !value.starts_with('{')) {
      add(entries_, path, value);
      return;
    }
    std::string flow(value);
    BracketCount brackets;
    for (int open = brackets.add(flow); open > 0 && !rest_.empty();) {
      const std::string_view line = without_comment(take_line());
      open = brackets.add(line);
      flow.append(" ").append(line);
    }
    FlowReader(flow, entries_).read(path);
  }

  std::string_view rest_;
  Entries& entries_;
  std::vector<Parent> parents_;
};

}  // namespace

SettingsText::SettingsText(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  if (trimmed(text).starts_with('{')) {
    FlowReader(text, entries_).read("");
  } else {
    BlockReader(text, entries_).read();
  }
}

std::string SettingsText::text(const std::string& path) const {
  const auto entry = entries_.find(path);
  return entry == entries_.end() || entry->second.values.empty() ? std::string() : entry->second.values.front();
}

std::optional<double> SettingsText::number(const std::string& path) const {
  return io::parse_number(text(path));
}

std::vector<double> SettingsText::numbers(const std::string& path) const {
  const auto entry = entries_.find(path);
  std::vector<double> values;
  if (entry == entries_.end()) return values;
  for (const std::string& value : entry->second.values) {
    for (const io::TextLine& line : io::split_lines(value, " \t,")) {  // "582.8 0 320" has one key, too
      for (const std::string& field : line.fields) {
        const std::optional<double> number = io::parse_number(field);
        if (!number) return {};
        values.push_back(*number);
      }
    }
  }
  return values;
}

std::string SettingsText::path_of(const std::string& name) const {
  const auto is_named = [&](const Entries::value_type& entry) {
    return entry.first == name || entry.first.ends_with("." + name);
  };
  auto first = entries_.end();
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry)
    if (is_named(*entry) && (first == entries_.end() || entry->second.place < first->second.place)) first = entry;
  return first == entries_.end() ? std::string() : first->first;
}

}  // namespace rtd::camera
