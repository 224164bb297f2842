// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros_codec/message_definition.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <sstream>

namespace rtd::ros {
namespace {

constexpr std::size_t kMaxTypes = 1000, kDeepest = 50;
constexpr const char* kBlanks = " \t\r";

const std::set<std::string>& primitives() {
  static const std::set<std::string> kTypes = {"bool",    "byte",   "char",    "int8",  "uint8",   "int16",
                                               "uint16",  "int32",  "uint32",  "int64", "uint64",  "float32",
                                               "float64", "string", "wstring", "time",  "duration"};
  return kTypes;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

bool is_name(const std::string& text) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) == 0 &&
         std::ranges::all_of(text, fits);
}

bool is_type_name(const std::string& text) {
  constexpr std::size_t kLongest = 255;  // fields repeat the name of their package
  if (text.size() > kLongest) return false;
  const std::size_t slash = text.find('/');
  return slash == std::string::npos ? is_name(text) : is_name(text.substr(0, slash)) && is_name(text.substr(slash + 1));
}

std::uint32_t array_size(const std::string& digits) {
  std::uint32_t size = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), size);
  if (error != std::errc() || end != digits.data() + digits.size())
    throw std::invalid_argument("'[" + digits + "]' is not the size of an array");
  return size;
}

/// "[]", "[<=5]", "[36]" at the end of a type.
void take_array(std::string& type, MessageField& field) {
  if (!type.ends_with(']')) return;
  const std::size_t begin = type.find('[');
  if (begin == std::string::npos) throw std::invalid_argument("type '" + type + "' has no '['");
  const std::string size = type.substr(begin + 1, type.size() - begin - 2);
  const bool sequence = size.empty() || size.starts_with("<=");
  field.kind = sequence ? MessageField::Kind::kSequence : MessageField::Kind::kArray;
  if (!sequence) field.capacity = array_size(size);
  type.resize(begin);
}

std::string resolve(const std::string& type, const std::string& package) {
  if (primitives().contains(type)) return type;
  if (type == "Header") return "std_msgs/Header";
  return type.find('/') == std::string::npos ? package + '/' + type : package_and_type(type);
}

/// One line without comment. False for a constant.
bool parse_field(const std::string& line, const std::string& package, MessageField& field) {
  const std::size_t type_end = line.find_first_of(kBlanks);
  if (type_end == std::string::npos) throw std::invalid_argument("'" + line + "' has no name");
  std::string type = line.substr(0, type_end);
  const std::string rest = trimmed(line.substr(type_end));
  field.name = rest.substr(0, rest.find_first_of(" \t\r="));
  if (!is_name(field.name)) throw std::invalid_argument("'" + field.name + "' is not the name of a field");
  const std::string behind = trimmed(rest.substr(field.name.size()));
  if (behind.starts_with('=')) return false;
  take_array(type, field);
  if (const std::size_t bound = type.find("<="); bound != std::string::npos) type.resize(bound);
  field.type = resolve(type, package);
  if (!is_type_name(field.type)) throw std::invalid_argument("'" + type + "' is not the name of a type");
  return true;
}

/// The line up to its comment; the value of a string constant may hold '#', but it is not used.
std::string without_comment(const std::string& line) {
  return trimmed(line.substr(0, line.find('#')));
}

bool separates(const std::string& line) {
  return line.size() >= 3 && line.find_first_not_of('=') == std::string::npos;
}

class Parser {
 public:
  explicit Parser(const std::string& type) : root_(type) { begin(type); }

  void take(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    for (number_ = 1; std::getline(lines, line); ++number_) {
      try {
        take_line(without_comment(line));
      } catch (const std::invalid_argument& error) {
        throw DefinitionError(place() + error.what() + "; expected: TYPE NAME, TYPE NAME=VALUE or MSG: PACKAGE/TYPE");
      }
    }
    if (separated_) throw DefinitionError(place() + "a line of '=' without 'MSG: PACKAGE/TYPE' behind it");
  }
  MessageFields result() && { return std::move(types_); }

 private:
  std::string place() const { return "definition of " + root_ + ", line " + std::to_string(number_) + ": "; }

  void begin(const std::string& type) {
    const std::size_t slash = type.find('/');
    if (slash == std::string::npos || !is_type_name(type)) {
      throw std::invalid_argument("'" + type + "' is not PACKAGE/TYPE");
    }
    if (types_.size() >= kMaxTypes) throw std::invalid_argument("more than " + std::to_string(kMaxTypes) + " types");
    package_ = type.substr(0, slash);
    fields_ = &types_[type];
    fields_->clear();  // a type given twice: the last text counts
  }

  void take_line(const std::string& line) {
    if (line.empty()) return;
    if (separates(line)) {
      separated_ = true;
    } else if (separated_) {
      if (!line.starts_with("MSG:")) throw std::invalid_argument("'" + line + "' follows a line of '='");
      begin(package_and_type(trimmed(line.substr(4))));
      separated_ = false;
    } else if (MessageField field; parse_field(line, package_, field)) {
      fields_->push_back(std::move(field));
    }
  }

  const std::string root_;
  MessageFields types_;
  std::vector<MessageField>* fields_ = nullptr;
  std::string package_;
  int number_ = 0;
  bool separated_ = false;
};

/// Some writers leave out the types of the base packages.
void add_base_types(MessageFields& types) {
  types.try_emplace("builtin_interfaces/Time", std::vector<MessageField>{{"int32", "sec"}, {"uint32", "nanosec"}});
  types.try_emplace("builtin_interfaces/Duration", std::vector<MessageField>{{"int32", "sec"}, {"uint32", "nanosec"}});
}

/// Copies what `type` is made of, depth first.
class Closure {
 public:
  explicit Closure(const MessageFields& all) : all_(all) {}

  void add(const std::string& type) {
    if (std::ranges::count(path_, type) != 0 || path_.size() >= kDeepest)
      throw DefinitionError("definition of " + path_.front() + ": type " + type + " is nested in itself or too deeply");
    if (used_.contains(type)) return;
    const auto found = all_.find(type);
    if (found == all_.end()) {
      throw DefinitionError("definition of " + path_.front() + ": the text of " + type + ", used by " + path_.back() +
                            ", is missing");
    }
    path_.push_back(type);
    for (const MessageField& field : found->second) {
      if (field.is_message()) add(field.type);
    }
    path_.pop_back();
    used_.insert(*found);
  }
  MessageFields take() { return std::move(used_); }

 private:
  const MessageFields& all_;
  MessageFields used_;
  std::vector<std::string> path_;
};

}  // namespace

std::string package_and_type(const std::string& type) {
  const std::size_t infix = type.find("/msg/");
  return infix == std::string::npos ? type : type.substr(0, infix) + type.substr(infix + 4);
}

MessageFields parse_definition(const std::string& type, const std::string& text) {
  try {
    const std::string root = package_and_type(type);
    Parser parser(root);
    parser.take(text);
    MessageFields all = std::move(parser).result();
    add_base_types(all);
    Closure closure(all);
    closure.add(root);
    return closure.take();
  } catch (const std::invalid_argument& error) {
    throw DefinitionError("definition of " + type + ": " + error.what());
  }
}

}  // namespace rtd::ros
