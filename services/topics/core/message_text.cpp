// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "common/service/command_line.hpp"
#include "common/service/json_text.hpp"
#include "services/topics/core/topic_report.hpp"

namespace rtd::topics {
namespace {

using Json = nlohmann::ordered_json;

/// A text made for people in place of a value.
bool is_text(const Json& value) {
  return value.is_object() && value.size() == 1 && value.contains("__text");
}

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
  if (is_text(shown)) {
    text += margin + name + ": " + shown["__text"].get<std::string>() + '\n';
  } else if (shown.is_array() && !holds_messages(shown)) {
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
  if (is_text(value)) {
    text += std::string(indent, ' ') + value["__text"].get<std::string>() + '\n';
    return;
  }
  for (const auto& [name, field] : value.items()) append_field(text, name, field, indent);
}

/// {"sec": 1, "nanosec": 5} of ROS.
bool is_time(const Json& value) {
  return value.is_object() && value.size() == 2 && value.contains("sec") && value.contains("nanosec") &&
         value["sec"].is_number_integer() && value["nanosec"].is_number_unsigned();
}

std::string time_text(const Json& time) {
  const auto sec = time["sec"].get<std::int64_t>();
  const auto nanosec = time["nanosec"].get<std::uint64_t>();
  if (sec < 0) return fmt::format("{} s + {} ns", sec, nanosec);
  return service::time_text(static_cast<std::uint64_t>(sec) * 1'000'000'000 + nanosec);
}

/// Numbers of one value, more than a few.
bool is_uniform(const Json& array) {
  constexpr std::size_t kFew = 4;
  if (!array.is_array() || array.size() <= kFew || !array.front().is_number()) return false;
  for (const Json& element : array)
    if (element != array.front()) return false;
  return true;
}

constexpr double kDigits = 1e6;  // behind the point: a micrometre

Json readable(const Json& value) {
  if (is_time(value)) return {{"__text", time_text(value)}};
  if (is_uniform(value)) return {{"__text", fmt::format("[{} x {}]", value.size(), value_text(value.front()))}};
  if (value.is_number_float()) {
    const double number = value.get<double>();
    return std::abs(number) < 1e9 && std::abs(number) > 1 / kDigits ? Json(std::round(number * kDigits) / kDigits)
                                                                    : value;
  }
  if (!value.is_structured() || is_cut(value)) return value;
  Json copy = value;
  for (Json& part : copy) part = readable(part);
  return copy;
}

}  // namespace

std::string message_text(const Json& message, Detail detail) {
  return detail == Detail::kAll ? message_text(message) : message_text(readable(message));
}

std::string message_text(const Json& message) {
  std::string text;
  append(text, message, 0);
  return text + "---\n";
}

}  // namespace rtd::topics
