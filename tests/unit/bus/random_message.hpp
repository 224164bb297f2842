// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

/// Visits the fields of the plain message structs without knowing their names, so that a test cannot forget a field.
namespace rtd::bus::reflect {

struct AnyField {
  template <class T>
  operator T() const;
};

template <class T, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
  return requires {
    T{((void)I, AnyField{})...};
  };
}

template <class T, std::size_t N = 20>
constexpr std::size_t field_count() {
  if constexpr (takes<T>(std::make_index_sequence<N>{})) {
    return N;
  } else {
    return field_count<T, N - 1>();
  }
}

/// Calls f with each field of the aggregate.
template <class T, class F>
void for_each_field(T& s, F f) {
  constexpr std::size_t n = field_count<std::remove_const_t<T>>();
  const auto all = [&](auto&... field) { (f(field), ...); };
  // clang-format off
  if constexpr (n == 1) { auto& [a] = s; all(a); }
  else if constexpr (n == 2) { auto& [a, b] = s; all(a, b); }
  else if constexpr (n == 3) { auto& [a, b, c] = s; all(a, b, c); }
  else if constexpr (n == 4) { auto& [a, b, c, d] = s; all(a, b, c, d); }
  else if constexpr (n == 5) { auto& [a, b, c, d, e] = s; all(a, b, c, d, e); }
  else if constexpr (n == 7) { auto& [a, b, c, d, e, g, h] = s; all(a, b, c, d, e, g, h); }
  else if constexpr (n == 9) { auto& [a, b, c, d, e, g, h, i, j] = s; all(a, b, c, d, e, g, h, i, j); }
  else { static_assert(n == 11, "add a line for this number of fields");
         auto& [a, b, c, d, e, g, h, i, j, k, l] = s; all(a, b, c, d, e, g, h, i, j, k, l); }
  // clang-format on
}

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t N>
struct IsArray<std::array<T, N>> : std::true_type {};

/// Fills every field with a random value; vectors get one to three elements, strings one to twelve letters.
template <class T>
void randomize(T& value, std::mt19937_64& random) {
  if constexpr (std::is_same_v<T, bool>) {
    value = !value;  // differs from the default
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(1 + random() % 5);
  } else if constexpr (std::is_floating_point_v<T>) {
    value = std::uniform_real_distribution<T>(1, 1000)(random);
  } else if constexpr (std::is_arithmetic_v<T>) {
    value = static_cast<T>(1 + random() % 120);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value.assign(1 + random() % 12, static_cast<char>('a' + random() % 26));
  } else if constexpr (IsVector<T>::value) {
    value.resize(1 + random() % 3);
    for (auto& element : value) randomize(element, random);
  } else if constexpr (IsArray<T>::value) {
    for (auto& element : value) randomize(element, random);
  } else {
    for_each_field(value, [&](auto& field) { randomize(field, random); });
  }
}

/// A number that changes with every field of the message.
template <class T>
std::uint64_t fingerprint(const T& value) {
  const auto mix = [](std::uint64_t seed, std::uint64_t next) { return (seed ^ next) * 1'099'511'628'211ULL + 17; };
  if constexpr (std::is_enum_v<T>) {
    return static_cast<std::uint64_t>(value);
  } else if constexpr (std::is_arithmetic_v<T>) {
    return std::hash<T>{}(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return std::hash<std::string>{}(value);
  } else {
    std::uint64_t seed = 1;
    const auto add = [&](const auto& part) { seed = mix(seed, fingerprint(part)); };
    if constexpr (IsVector<T>::value || IsArray<T>::value) {
      for (const auto& element : value) add(element);
    } else {
      for_each_field(value, add);
    }
    return seed;
  }
}

}  // namespace rtd::bus::reflect
