// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/surface_beliefs.hpp"

#include <utility>

namespace rtd::filter {

void SurfaceBeliefs::store(const DepthGrid& grid, CellBeliefs beliefs) {
  shape_ = grid.shape;
  depth_m_ = grid.depth_m;
  beliefs_ = std::move(beliefs);
}

float SurfaceBeliefs::near(int cell, float depth_m, float tolerance_m) const {
  const int column = cell % shape_.columns;
  const auto fits = [&](int at) { return std::abs(depth_m_[static_cast<std::size_t>(at)] - depth_m) < tolerance_m; };
  if (fits(cell)) return beliefs_[static_cast<std::size_t>(cell)];
  if (column > 0 && fits(cell - 1)) return beliefs_[static_cast<std::size_t>(cell - 1)];
  if (column + 1 < shape_.columns && fits(cell + 1)) return beliefs_[static_cast<std::size_t>(cell + 1)];
  if (cell >= shape_.columns && fits(cell - shape_.columns))
    return beliefs_[static_cast<std::size_t>(cell - shape_.columns)];
  if (cell + shape_.columns < shape_.size() && fits(cell + shape_.columns))
    return beliefs_[static_cast<std::size_t>(cell + shape_.columns)];
  return kNoBelief;
}

CellBeliefs SurfaceBeliefs::recall(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays,
                                   const geometry::CameraModel& camera, const Eigen::Isometry3d& T_last_current,
                                   const CellMask* where, float tolerance_m) const {
  constexpr float kMinDepthM = 0.1F;
  CellBeliefs recalled(grid.depth_m.size(), kNoBelief);
  if (beliefs_.empty() || !(shape_ == grid.shape)) return recalled;
  const Eigen::Matrix3f rotation = T_last_current.linear().cast<float>();
  const Eigen::Vector3f translation = T_last_current.translation().cast<float>();
  const auto& p = camera.parameters();
  const auto fx = static_cast<float>(p.fx), fy = static_cast<float>(p.fy);
  const auto cx = static_cast<float>(p.cx), cy = static_cast<float>(p.cy);
  for (std::size_t cell = 0; cell < recalled.size(); ++cell) {
    if (grid.depth_m[cell] <= 0 || (where != nullptr && (*where)[cell] == 0)) continue;
    const Eigen::Vector3f p_last = rotation * (rays[cell] * grid.depth_m[cell]) + translation;
    if (p_last.z() < kMinDepthM) continue;
    const int at = shape_.cell_at(fx * p_last.x() / p_last.z() + cx, fy * p_last.y() / p_last.z() + cy);
    if (at >= 0) recalled[cell] = near(at, p_last.z(), tolerance_m);
  }
  return recalled;
}

}  // namespace rtd::filter
