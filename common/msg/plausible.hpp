// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/io/utf8.hpp"
#include "common/msg/field_rules.hpp"
#include "common/msg/fields.hpp"

/// Whether a message from outside holds only what an honest program sends: each field by its rule
/// (common/msg/field_rules.hpp), then the message's own rule, broken_rule(), which is next to its RTD_FIELDS line.
/// The bus asks for every message before its readers see it, so cores may rely on it. Allocates nothing, throws
/// nothing.
namespace rtd::msg {

/// The first field that cannot be; both names are literals.
struct ImplausibleField {
  const char* type = nullptr;   ///< nullptr: there is none
  const char* field = nullptr;  ///< or several, as "width and height"
  explicit operator bool() const { return type != nullptr; }
};
/// "rtd_msgs/Feature.octave"
inline std::string to_string(const ImplausibleField& bad) {
  return bad ? std::string(bad.type) + '.' + bad.field : std::string();
}

/// The fields of a message that do not go together; nullptr when all do. Asked only when each alone holds its rule.
/// Overloads are next to the messages.
template <Message T>
constexpr const char* broken_rule(const T&) {
  return nullptr;
}

/// The part of a field that counts. Overloads are next to the messages.
template <Message T, class Field>
constexpr const Field& used_part(const T&, const Field& field) {
  return field;
}

namespace plausible {

template <class T>
struct Element {
  using Type = T;
};
template <class T>
struct Element<std::vector<T>> : Element<T> {};
template <class T, std::size_t kSize>
struct Element<std::array<T, kSize>> : Element<T> {};
template <class T>
requires requires {
  typename T::Number;
}
struct Element<T> {
  using Type = typename T::Number;
};

template <class T>
inline constexpr bool kWhole = std::is_integral_v<T> && !std::is_same_v<T, bool>;

template <class Field>
constexpr FieldRule rule_of(std::string_view type, std::string_view name) {
  using Value = typename Element<Field>::Type;
  if (const std::size_t place = find_rule(type, name); place != kNoRule) return kFieldRules[place];
  if (!kWhole<Value>) return {};
  const bool time = std::is_same_v<Value, std::int64_t> && name.ends_with("_ns");
  if (!time) throw "a field of whole numbers has no entry in common/msg/field_rules.hpp";  // does not compile
  return within(name, kMaxTime_ns);
}

template <Message T>
consteval std::size_t field_count() {
  std::size_t count = 0;
  for_each_field_type<T>([&]<class Field>(const char*) { ++count; });
  return count;
}

/// The rules of the fields of T, in their order.
template <Message T>
inline constexpr auto kRules = [] {
  std::array<FieldRule, field_count<T>()> rules{};
  std::size_t place = 0;
  for_each_field_type<T>(
      [&]<class Field>(const char* name) { rules[place++] = rule_of<Field>(type_name(TypeOf<T>()), name); });
  return rules;
}();

template <class T>
requires std::is_arithmetic_v<T>
constexpr bool holds(T value, const FieldRule& rule) {
  if constexpr (std::is_same_v<T, bool>) {
    return true;
  } else if constexpr (std::is_floating_point_v<T>) {
    constexpr double kLargest = std::numeric_limits<T>::max();
    return value >= static_cast<T>(std::max(rule.least, -kLargest)) &&
           value <= static_cast<T>(std::min(rule.most, kLargest));
  } else {
    const auto number = static_cast<double>(value);
    return rule.free || (number >= rule.least && number <= rule.most);
  }
}

template <class T>
requires std::is_enum_v<T>
constexpr bool holds(T value, const FieldRule&) {
  return value >= T{} && value <= last_value(TypeOf<T>());
}

constexpr bool holds(char32_t code, TextRule rule) {
  if (rule == TextRule::kToken) return code > ' ' && code < 0x7f;
  if (rule == TextRule::kLines && (code == '\n' || code == '\r' || code == '\t')) return true;
  return !io::is_control(code);
}

constexpr bool holds(std::string_view text, const FieldRule& rule) {
  if (text.size() > (rule.most_count > 0 ? rule.most_count : kMaxText)) return false;
  while (!text.empty()) {
    const io::Utf8Character character = io::first_character(text);
    if (character.bytes == 0 || !holds(character.code, rule.text)) return false;
    text.remove_prefix(character.bytes);
  }
  return true;
}
inline bool holds(const std::string& text, const FieldRule& rule) {
  return holds(std::string_view(text), rule);
}

template <class T>
requires requires {
  typename T::Number;
}
bool holds(const T& number, const FieldRule& rule) {
  return holds(number.value(), rule);
}

template <Message T>
bool holds(const T& message, const FieldRule& = {});

template <class T>
bool holds(std::span<const T> values, const FieldRule& rule) {
  if (kWhole<T> && rule.free) return true;
  bool all = true;
  for (const T& value : values) all &= holds(value, rule);  // no early end: numbers are checked side by side
  return all;
}
template <class T, std::size_t kSize>
bool holds(const std::array<T, kSize>& values, const FieldRule& rule) {
  return holds(std::span<const T>(values), rule);
}
template <class T>
constexpr std::size_t most_elements(const FieldRule& rule) {
  if (rule.most_count > 0) return rule.most_count;
  return std::is_arithmetic_v<T> ? kMaxBytes / sizeof(T) : kMaxElements;
}
template <class T>
bool holds(const std::vector<T>& values, const FieldRule& rule) {
  return values.size() <= most_elements<T>(rule) && holds(std::span<const T>(values), rule);
}

template <Message T>
bool hold_all(const T& message) {
  bool all = true;
  std::size_t place = 0;
  for_each_field(message, [&](const char*, const auto& field) {
    const FieldRule& rule = kRules<T>[place++];
    all = all && holds(used_part(message, field), rule);
  });
  return all;
}

template <Message T>
bool holds(const T& message, const FieldRule&) {
  return hold_all(message) && broken_rule(message) == nullptr;
}

/// Of a message that does not hold.
template <Message T>
ImplausibleField find(const T& message);

template <class T>
ImplausibleField find_in(const T& field, const ImplausibleField& itself) {
  if constexpr (Message<T>) {
    return find(field);
  } else if constexpr (requires { requires Message<typename T::value_type>; }) {
    const auto bad = std::ranges::find_if(field, [](const auto& element) { return !holds(element); });
    return bad != field.end() ? find(*bad) : itself;  // itself: too many
  } else {
    return itself;
  }
}

template <Message T>
ImplausibleField find(const T& message) {
  constexpr const char* kType = type_name(TypeOf<T>());
  ImplausibleField bad;
  std::size_t place = 0;
  for_each_field(message, [&](const char* name, const auto& field) {
    const FieldRule& rule = kRules<T>[place++];
    const auto& used = used_part(message, field);
    if (!bad && !holds(used, rule)) bad = find_in(used, {kType, name});
  });
  return bad ? bad : ImplausibleField{kType, broken_rule(message)};
}

}  // namespace plausible

/// The first field that an honest program would not send so.
template <Message T>
ImplausibleField implausible_field(const T& message) {
  return plausible::holds(message) ? ImplausibleField() : plausible::find(message);
}

template <Message T>
bool is_plausible(const T& message) {
  return plausible::holds(message);
}

}  // namespace rtd::msg
