// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "common/msg/fields.hpp"

/// Messages with random content, by their lists of fields.
namespace rtd::bus::reflect {

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
    const auto letter = static_cast<char>('a' + random() % 26);
    value.assign(1 + random() % 12, letter);
  } else if constexpr (IsVector<T>::value) {
    value.resize(1 + random() % 3);
    for (auto& element : value) randomize(element, random);
  } else if constexpr (IsArray<T>::value) {
    for (auto& element : value) randomize(element, random);
  } else {
    msg::for_each_field(value, [&](const char*, auto& field) { randomize(field, random); });
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
      msg::for_each_field(value, [&](const char*, const auto& field) { add(field); });
    }
    return seed;
  }
}

}  // namespace rtd::bus::reflect
