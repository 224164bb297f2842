// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/json_text.hpp"
#include "services/topics/core/topic_report.hpp"

#include <fmt/format.h>

namespace rtd::topics {
namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const Json& value) {
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());  // the shortest that reads back the same
  if (value.is_string() && (value == "nan" || value == "inf" || value == "-inf")) return '.' + value.get<std::string>();
  return service::json_line(value);
}

bool holds_messages(const Json& array) {
  return !array.empty() && array.front().is_object();
}

/// An array of which only the beginning was kept.
bool is_cut(const Json& value) {
  return value.is_object() && value.size() == 2 && value.contains("count") && value.contains("first") &&
         value["first"].is_array();
}

void append(std::string& text, const Json& value, std::size_t indent);

void append_elements(std::string& text, const Json& array, std::size_t indent) {
  for (const Json& element : array) {
    std::string part;
    append(part, element, indent + 2);
    if (part.size() > indent) part[indent] = '-';
    text += part;
  }
}

void append_field(std::string& text, const std::string& name, const Json& value, std::size_t indent) {
  const std::string margin(indent, ' ');
  const bool cut = is_cut(value);
  const Json& shown = cut ? value["first"] : value;
  if (shown.is_array() && !holds_messages(shown)) {
    text += margin + name + ": [";
    for (std::size_t i = 0; i < shown.size(); ++i) text += (i == 0 ? "" : ", ") + value_text(shown[i]);
    text +=
        cut ? fmt::format("{}... {} values]\n", shown.empty() ? "" : ", ", value["count"].get<std::size_t>()) : "]\n";
  } else if (shown.is_array()) {
    text += fmt::format("{}{}:{}\n", margin, name,
                        cut ? fmt::format("  # the first of {}", value["count"].get<std::size_t>()) : "");
    append_elements(text, shown, indent);
  } else if (shown.is_object()) {
    text += margin + name + ":\n";
    append(text, shown, indent + 2);
  } else {
    text += margin + name + ": " + value_text(shown) + '\n';
  }
}

void append(std::string& text, const Json& value, std::size_t indent) {
  for (const auto& [name, field] : value.items()) append_field(text, name, field, indent);
}

}  // namespace

std::string message_text(const Json& message) {
  std::string text;
  append(text, message, 0);
  return text + "---\n";
}

}  // namespace rtd::topics
