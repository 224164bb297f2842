// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rtd::camera::synthetic {

/// A small generator with the same numbers on every platform and library (splitmix64, Steele et al. 2014).
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  float unit() { return static_cast<float>(next() >> 40) * (1.0F / 16777216.0F); }
  float between(float low, float high) { return low + (high - low) * unit(); }
  /// In [0, count).
  int index(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  /// Approximately normal, mean 0, variance 1 (sum of 12 uniform numbers).
  float normal() {
    float sum = -6.0F;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }

 private:
  std::uint64_t state_;
};

}  // namespace rtd::camera::synthetic
