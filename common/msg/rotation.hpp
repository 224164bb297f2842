// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace rtd::msg {

/// Whether x y z w is a unit quaternion, but for rounding in another program.
constexpr bool is_rotation(const std::array<double, 4>& q) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return square > 0.25 && square < 4;
}

/// Many programs leave a rotation that they do not know at 0 0 0 0.
constexpr bool is_rotation_or_unset(const std::array<double, 4>& q) {
  return is_rotation(q) || q == std::array<double, 4>{};
}

}  // namespace rtd::msg
