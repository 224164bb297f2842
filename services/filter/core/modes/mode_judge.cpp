// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/mode_judge.hpp"

#include <algorithm>

namespace rtd::filter {

std::vector<CellMotion> to_cell_motion(const CellMask& dynamic, bool others_rest) {
  std::vector<CellMotion> motion(dynamic.size());
  std::transform(dynamic.begin(), dynamic.end(), motion.begin(), [others_rest](std::uint8_t moves) {
    return moves != 0 ? CellMotion::kDynamic : others_rest ? CellMotion::kStatic : CellMotion::kUnknown;
  });
  return motion;
}

void ModeJudge::on_keyframe(const SlamKeyframe& keyframe) {
  if (keyframe.removed) {
    views_.forget_keyframe(keyframe.seq);
  } else {
    views_.mark_keyframe(keyframe.seq, keyframe.T_world_camera);
  }
}

void mark(msg::Feature& feature, bool moving) {
  constexpr float kMoving = 0.02F;
  feature.static_probability = moving ? kMoving : 1.0F;
  if (moving) feature.flags |= msg::kFeatureRemoved;
}

}  // namespace rtd::filter
