// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// Inlined into functions for another instruction set, too.
#define RTD_INLINE inline __attribute__((always_inline))

/// Of a function that is only called where wide_vectors().
#if defined(__x86_64__)
#define RTD_AVX2 __attribute__((target("avx2")))
#else
#define RTD_AVX2
#endif

// Vectors wider than the default instruction set's are only passed to inlined functions.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace rtd::vision {

/// Whether the processor has vectors of 32 bytes.
inline bool wide_vectors() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

template <int kLanes>
struct Vectors;
template <>
struct Vectors<4> {
  using Floats = float __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(16)));
  using Pairs = std::int64_t __attribute__((vector_size(16), may_alias));
  using Shorts = std::uint16_t __attribute__((vector_size(8)));
  using FloatsInRow = float __attribute__((vector_size(16), aligned(4)));
  using IntsInRow = std::int32_t __attribute__((vector_size(16), aligned(4)));
  using ShortsInRow = std::uint16_t __attribute__((vector_size(8), aligned(2)));
};
template <>
struct Vectors<8> {
  using Floats = float __attribute__((vector_size(32)));
  using Ints = std::int32_t __attribute__((vector_size(32)));
  using Pairs = std::int64_t __attribute__((vector_size(32), may_alias));
  using Shorts = std::uint16_t __attribute__((vector_size(16)));
  using FloatsInRow = float __attribute__((vector_size(32), aligned(4)));
  using IntsInRow = std::int32_t __attribute__((vector_size(32), aligned(4)));
  using ShortsInRow = std::uint16_t __attribute__((vector_size(16), aligned(2)));
};

/// kLanes pixels at a time, in the vectors of GCC and Clang: operators work by element, comparisons give -1 or 0.
template <int kLanes>
struct Lanes : Vectors<kLanes> {
  using typename Vectors<kLanes>::Floats;
  using typename Vectors<kLanes>::Ints;
  using typename Vectors<kLanes>::Pairs;
  using typename Vectors<kLanes>::Shorts;
  using typename Vectors<kLanes>::FloatsInRow;
  using typename Vectors<kLanes>::IntsInRow;
  using typename Vectors<kLanes>::ShortsInRow;

  template <class Number>
  static RTD_INLINE Floats all(Number value) {
    return Floats{} + static_cast<float>(value);
  }
  static RTD_INLINE Floats load(const float* from) { return *reinterpret_cast<const FloatsInRow*>(from); }
  static RTD_INLINE Floats load(const std::uint16_t* from) {
    const Shorts shorts = *reinterpret_cast<const ShortsInRow*>(from);
    return floats(__builtin_convertvector(shorts, Ints));
  }
  static RTD_INLINE void store(float* to, const Floats& vector) { *reinterpret_cast<FloatsInRow*>(to) = vector; }
  static RTD_INLINE void store(std::int32_t* to, const Ints& vector) { *reinterpret_cast<IntsInRow*>(to) = vector; }
  /// Keeps what is less; the numbers fit.
  static RTD_INLINE void store_lesser(std::uint16_t* to, const Ints& vector) {
    const Shorts before = *reinterpret_cast<const ShortsInRow*>(to), now = __builtin_convertvector(vector, Shorts);
    *reinterpret_cast<ShortsInRow*>(to) = now < before ? now : before;
  }

  static RTD_INLINE Floats floats(const Ints& a) { return __builtin_convertvector(a, Floats); }
  /// Rounds towards zero.
  static RTD_INLINE Ints ints(const Floats& a) { return __builtin_convertvector(a, Ints); }
  static RTD_INLINE Floats lesser(const Floats& a, const Floats& b) { return a < b ? a : b; }
  static RTD_INLINE Floats greater(const Floats& a, const Floats& b) { return a > b ? a : b; }
  static RTD_INLINE Floats within(const Floats& a, const Floats& low, const Floats& high) {
    return lesser(greater(a, low), high);
  }
  static RTD_INLINE Floats magnitude(const Floats& a) { return greater(a, -a); }
  /// Whether a condition holds anywhere.
  static RTD_INLINE bool any(const Ints& holds) {
    const Pairs pairs = reinterpret_cast<const Pairs&>(holds);
    std::int64_t some = 0;
    for (std::size_t i = 0; i < sizeof pairs / sizeof some; ++i) some |= pairs[i];
    return some != 0;
  }
  /// 0 where the condition does not hold, whatever stands there.
  static RTD_INLINE Floats where(const Ints& holds, const Floats& a) { return holds ? a : Floats{}; }
};

}  // namespace rtd::vision

#pragma GCC diagnostic pop
