// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

/// Arithmetic with stamps from outside, which may be any number of 64 bits: a result that has no room is the nearest
/// that has, so that a forged stamp is very old or very far ahead and never undefined.
namespace rtd::msg {

/// Bound of all results: their sign can be changed, and std::abs() of them exists.
inline constexpr std::int64_t kMaxNs = std::numeric_limits<std::int64_t>::max();

/// a - b, within +-kMaxNs.
constexpr std::int64_t minus_ns(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) return a < b ? -kMaxNs : kMaxNs;
  return std::max(difference, -kMaxNs);
}

/// a + b, within +-kMaxNs.
constexpr std::int64_t plus_ns(std::int64_t a, std::int64_t b) {
  std::int64_t sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) return a < 0 ? -kMaxNs : kMaxNs;
  return std::max(sum, -kMaxNs);
}

/// Time between two stamps, whichever is later.
constexpr std::int64_t apart_ns(std::int64_t a, std::int64_t b) {
  return a < b ? minus_ns(b, a) : minus_ns(a, b);
}

/// later - earlier, s.
constexpr double minus_s(std::int64_t later_ns, std::int64_t earlier_ns) {
  return 1e-9 * static_cast<double>(minus_ns(later_ns, earlier_ns));
}

/// Seconds as nanoseconds, rounded towards 0; 0 for NaN.
constexpr std::int64_t ns_of(double seconds) {
  constexpr double kMax = 9.2e18;  // fits; so does its negative
  const double ns = 1e9 * seconds;
  return ns == ns ? static_cast<std::int64_t>(std::clamp(ns, -kMax, kMax)) : 0;
}

/// Bound of a sensor's readout time and of the time between its colour and depth image, s, of either sign.
inline constexpr double kMaxSensorTime_s = 0.1;

/// Whether such a time is finite and within its bound.
inline bool is_sensor_time(double time_s) {
  return std::abs(time_s) <= kMaxSensorTime_s;
}

}  // namespace rtd::msg
