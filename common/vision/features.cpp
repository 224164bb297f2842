// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/features.hpp"

#include <limits>
#include <numeric>
#include <stdexcept>

namespace rtd::vision {

namespace {

int cells_along(int side_px, int cell_px) {
  const std::int64_t cells = (std::int64_t{side_px} + cell_px - 1) / cell_px;
  return static_cast<int>(std::clamp<std::int64_t>(cells, 1, FeatureGrid::kMaxCells));
}

}  // namespace

FeatureGrid::FeatureGrid(std::span<const msg::Feature> features, int width_px, int height_px, int cell_px)
    : features_(features),
      inverse_cell_px_(1.0F / static_cast<float>(cell_px)),
      columns_(cells_along(width_px, cell_px)),
      rows_(cells_along(height_px, cell_px)),
      starts_(static_cast<std::size_t>(columns_) * rows_ + 1, 0),
      indices_(features.size()) {
  if (features.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::length_error("a feature grid holds at most 65535 features");
  }
  const auto cell_of = [this](const msg::Feature& feature) {
    return static_cast<std::size_t>(row_of(feature.v_px) * columns_ + column_of(feature.u_px));
  };
  for (const msg::Feature& feature : features) ++starts_[cell_of(feature) + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  std::vector<std::uint16_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < features.size(); ++i) {
    indices_[next[cell_of(features[i])]++] = static_cast<std::uint16_t>(i);
  }
}

std::vector<std::uint32_t> FeatureGrid::find(const SearchWindow& window) const {
  std::vector<std::uint32_t> found;
  for_each(window, [&](std::uint32_t index) { found.push_back(index); });
  return found;
}

}  // namespace rtd::vision
