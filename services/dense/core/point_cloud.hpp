// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <iosfwd>
#include <vector>

namespace rtd::dense {

/// A point of the published map.
struct CloudPoint {
  Eigen::Vector3f p_world = Eigen::Vector3f::Zero();  ///< m
  std::array<float, 3> bgr{};                         ///< 0..255
  float weight = 0;                                   ///< in points seen at 1 m
};

/// Weighted means of the points of each cube of `cell_m`; in the order of each cube's first point.
std::vector<CloudPoint> merge_by_cell(const std::vector<CloudPoint>& points, double cell_m);

/// A colour as it is written: whole numbers, 0..255.
std::uint8_t to_byte(float value);

/// Binary PLY: x y z (float, m, world frame) red green blue (uchar) weight (float).
void write_ply(std::ostream& out, const std::vector<CloudPoint>& points);

}  // namespace rtd::dense
