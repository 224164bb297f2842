// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "common/msg/fields.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::testing {

/// Makes messages hostile but well-formed: each field that is attacked becomes a bound, an extreme, not a number, a
/// text with control characters, a list that is empty, long or all the same. Goes by the one field list, so that a new
/// field is attacked by itself. Deterministic for a seed.
class Attacker {
 public:
  using Random = std::mt19937_64;

  explicit Attacker(std::uint64_t seed) : random_(seed) {}

  Random& random() { return random_; }
  std::uint64_t below(std::uint64_t end) { return random_() % end; }
  bool one_in(std::uint64_t n) { return below(n) == 0; }
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  /// Leaves 2 of 5 messages as they are; else changes one field, a few or all.
  template <msg::Message T>
  void attack(T& message) {
    const std::uint64_t kind = below(10);
    if (kind < 4) return;
    if (kind == 9) return spoil_all(message);
    for (std::uint64_t fields = kind < 8 ? 1 : 2 + below(3); fields > 0; --fields) spoil_one(message);
  }

  /// Changes one field, or one of a message within.
  template <msg::Message T>
  void spoil_one(T& message) {
    std::uint64_t count = 0;
    msg::for_each_field(message, [&](const char*, auto&) { ++count; });
    const std::uint64_t chosen = below(count);
    std::uint64_t place = 0;
    msg::for_each_field(message, [&](const char*, auto& field) {
      if (place++ == chosen) spoil(field);
    });
  }
  template <msg::Message T>
  void spoil_all(T& message) {
    msg::for_each_field(message, [&](const char*, auto& field) { spoil(field); });
  }

  template <class Field>
  void spoil(Field& field) {
    if constexpr (msg::Message<Field>) {
      spoil_one(field);
    } else if constexpr (std::is_same_v<Field, bool>) {
      field = one_in(2);
    } else if constexpr (std::is_enum_v<Field>) {
      field = static_cast<Field>(one_in(2) ? below(9) : hostile_number<std::underlying_type_t<Field>>(0));
    } else if constexpr (std::is_arithmetic_v<Field>) {
      field = hostile_number(field);
    } else {
      spoil_list(field);
    }
  }

 private:
  /// Lists within lists stay short: a message is no larger than the bus carries.
  class Within {
   public:
    explicit Within(int& depth) : depth_(depth) { ++depth_; }
    ~Within() { --depth_; }
    Within(const Within&) = delete;
    Within& operator=(const Within&) = delete;

   private:
    int& depth_;
  };

  template <class T>
  T hostile_number(T value) {
    if constexpr (std::is_floating_point_v<T>) {
      using Limits = std::numeric_limits<T>;
      const std::array<T, 20> values{T{0},
                                     -T{0},
                                     T{1},
                                     T{-1},
                                     T(0.5),
                                     T(1e-3),
                                     T(1e-30),
                                     T(1e30),
                                     T(1e4),
                                     T(-1e4),
                                     T(1e9),
                                     Limits::max(),
                                     value + 1,
                                     Limits::lowest(),
                                     -value,
                                     Limits::denorm_min(),
                                     value * 2,
                                     Limits::quiet_NaN(),
                                     T(between(-1, 1)),
                                     one_in(2) ? Limits::infinity() : -Limits::infinity()};
      return values[below(values.size())];
    } else {
      using Limits = std::numeric_limits<T>;
      constexpr auto kYearNs = static_cast<T>(sizeof(T) == 8 ? 31'557'600'000'000'000 : 1000);
      const std::array<T, 20> values{T{0},
                                     T{1},
                                     static_cast<T>(-1),
                                     Limits::min(),
                                     Limits::max(),
                                     static_cast<T>(Limits::max() - 1),
                                     static_cast<T>(Limits::min() + 1),
                                     static_cast<T>(static_cast<std::uint64_t>(value) + 1),
                                     static_cast<T>(static_cast<std::uint64_t>(value) - 1),
                                     static_cast<T>(static_cast<std::uint64_t>(value) + kYearNs),
                                     static_cast<T>(static_cast<std::uint64_t>(value) - kYearNs),
                                     static_cast<T>(4'000'000'000'000'000'000),
                                     static_cast<T>(-4'000'000'000'000'000'000),
                                     static_cast<T>(0xFFFFFFFC),
                                     static_cast<T>(0x7FFFFFFF),
                                     static_cast<T>(below(64)),
                                     static_cast<T>(below(2000)),
                                     static_cast<T>(random_()),
                                     static_cast<T>(static_cast<std::uint64_t>(value) << below(33)),
                                     static_cast<T>(std::uint64_t{1} << below(64))};
      return values[below(values.size())];
    }
  }

  template <class T>
  void spoil(msg::Unaligned<T>& number) {
    number = hostile_number(number.value());
  }

  void spoil_list(std::string& text) {
    const std::array<std::string, 9> texts{"",
                                           "\x1b[2J\x1b]0;owned\a",
                                           "a\nevent=forged level=info",
                                           std::string("with\0nul", 8),
                                           "../../../../etc/passwd",
                                           "\xff\xfe\xc3(",
                                           std::string(300, 'x'),
                                           std::string(70'000, 'y'),
                                           text + text};
    text = texts[below(texts.size())];
    text.resize(std::min<std::size_t>(text.size(), depth_ > 0 ? 1000 : 100'000));
  }

  template <class E, std::size_t kSize>
  void spoil_list(std::array<E, kSize>& list) {
    spoil_elements(list.data(), kSize);
  }

  template <class E>
  void spoil_list(std::vector<E>& list) {
    const std::size_t most = (depth_ > 0 ? 1 << 12 : msg::Message<E> ? 1 << 15 : 1 << 19) / sizeof(E) + 1;
    switch (below(6)) {
      case 0:
        list.clear();
        break;
      case 1:
        list.resize(list.size() / 2);
        break;
      case 2:
        list.resize(list.size() + 1 + below(3));
        break;
      case 3:
        if (!list.empty()) list.resize(std::min(most, 1 + below(one_in(8) ? most : 100)), E(list.front()));
        break;
      default:
        if (list.empty()) list.resize(1 + below(4));
        if constexpr (!std::is_same_v<E, bool>) spoil_elements(list.data(), list.size());
    }
  }

  /// A few, or all alike.
  template <class E>
  void spoil_elements(E* elements, std::size_t size) {
    if (size == 0) return;
    const Within within(depth_);
    if (one_in(4)) {
      E& first = elements[below(std::min<std::size_t>(size, 16))];
      if (one_in(2)) spoil(first);
      const E all = first;
      const std::size_t most = std::min<std::size_t>(size, 20'000);  // of an image: the beginning
      for (std::size_t i = 0; i < most; ++i) elements[i] = all;
      return;
    }
    for (std::uint64_t changes = 1 + below(8); changes > 0; --changes)
      spoil(elements[below(one_in(2) ? size : std::min<std::size_t>(size, 64))]);
  }

  Random random_;
  int depth_ = 0;
};

}  // namespace rtd::testing
