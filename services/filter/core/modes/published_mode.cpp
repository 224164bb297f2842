// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/published_mode.hpp"

#include "services/filter/core/modes/epipolar_mode.hpp"
#include "services/filter/core/modes/paper_mode.hpp"

namespace rtd::filter {

std::unique_ptr<PublishedMode> make_published_mode(const FilterConfig& config) {
  if (config.mode == FilterMode::kEpipolar) return std::make_unique<EpipolarMode>(config);
  if (config.mode == FilterMode::kRtdPaper) return std::make_unique<PaperMode>(config);
  return nullptr;
}

void mark(msg::Feature& feature, bool moving) {
  constexpr float kMoving = 0.02F;
  feature.static_probability = moving ? kMoving : 1.0F;
  if (moving) feature.flags |= msg::kFeatureRemoved;
}

CellMask cells_of_level(const PublishedInput& input, MotionLevel level, int dilate_cells) {
  CellMask mask(static_cast<std::size_t>(input.shape.size()), 0);
  for (const SceneObject& object : input.objects) {
    if (object.level != level) continue;
    for (const int cell : object.cells) mask[static_cast<std::size_t>(cell)] = 1;
  }
  return dilate_cells > 0 ? dilate(input.shape, mask, dilate_cells) : mask;
}

}  // namespace rtd::filter
