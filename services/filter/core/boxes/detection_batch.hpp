// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/vision/detection.hpp"

namespace rtd::filter {

/// The boxes that the detector found in the frame with this stamp, perhaps none.
struct DetectionBatch {
  std::int64_t stamp_ns = 0;
  std::vector<vision::Detection> detections;
};

/// What has arrived from the detector since the previous frame.
struct DetectorUpdate {
  bool active = false;                  ///< a detector is running: no batch means "not yet"; false: geometry only
  std::vector<DetectionBatch> batches;  ///< new ones by stamp, of this frame or, arriving late, of earlier ones
};

/// The boxes of one frame; nullopt = no detector is running.
using Detections = std::optional<std::vector<vision::Detection>>;
/// The update that brings the boxes of exactly this frame.
inline DetectorUpdate update_for(std::int64_t stamp_ns, const Detections& detections) {
  if (!detections) return {};
  return {true, {{stamp_ns, *detections}}};
}

}  // namespace rtd::filter
