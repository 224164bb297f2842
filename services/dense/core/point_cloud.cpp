// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ostream>
#include <unordered_map>

#include "common/geometry/ply.hpp"

namespace rtd::dense {
namespace {

using Cell = Eigen::Array3i;
struct CellHash {
  std::size_t operator()(const Cell& c) const {
    return static_cast<std::size_t>(c.x()) * 73856093U ^ static_cast<std::size_t>(c.y()) * 19349663U ^
           static_cast<std::size_t>(c.z()) * 83492791U;
  }
};
struct CellEqual {
  bool operator()(const Cell& a, const Cell& b) const { return (a == b).all(); }
};

void add(CloudPoint& mean, const CloudPoint& point) {
  mean.weight += point.weight;
  const float share = mean.weight > 0 ? point.weight / mean.weight : 1.0F;
  mean.p_world += share * (point.p_world - mean.p_world);
  for (std::size_t i = 0; i < 3; ++i) mean.bgr[i] += share * (point.bgr[i] - mean.bgr[i]);
}

}  // namespace

std::vector<CloudPoint> merge_by_cell(const std::vector<CloudPoint>& points, double cell_m) {
  std::unordered_map<Cell, std::size_t, CellHash, CellEqual> place;
  std::vector<CloudPoint> merged;
  for (const CloudPoint& point : points) {
    const Cell cell = (point.p_world / static_cast<float>(cell_m)).array().floor().cast<int>();
    const auto [slot, fresh] = place.emplace(cell, merged.size());
    if (fresh) merged.emplace_back();
    add(merged[slot->second], point);
  }
  return merged;
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

void write_ply(std::ostream& out, const std::vector<CloudPoint>& points) {
  geometry::write_ply_header(out, geometry::PlyFormat::kBinaryLittleEndian, "RTD-SLAM static map, world frame, metres",
                             points.size(),
                             {{"float", "x"},
                              {"float", "y"},
                              {"float", "z"},
                              {"uchar", "red"},
                              {"uchar", "green"},
                              {"uchar", "blue"},
                              {"float", "weight"}});
  for (const CloudPoint& point : points) {
    std::array<char, 19> vertex{};
    const std::array<char, 3> rgb{static_cast<char>(to_byte(point.bgr[2])), static_cast<char>(to_byte(point.bgr[1])),
                                  static_cast<char>(to_byte(point.bgr[0]))};
    std::memcpy(vertex.data(), point.p_world.data(), 12);
    std::memcpy(vertex.data() + 12, rgb.data(), 3);
    std::memcpy(vertex.data() + 15, &point.weight, 4);
    out.write(vertex.data(), vertex.size());
  }
}

}  // namespace rtd::dense
