// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "common/msg/features.hpp"

namespace rtd::vision {

/// Number of differing bits of two 256-bit descriptors.
inline int hamming_distance(const msg::Descriptor& a, const msg::Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t x = 0, y = 0;
    std::memcpy(&x, a.data() + i, sizeof(x));
    std::memcpy(&y, b.data() + i, sizeof(y));
    distance += std::popcount(x ^ y);
  }
  return distance;
}

}  // namespace rtd::vision
