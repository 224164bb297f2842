// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/vision/detection.hpp"

namespace rtd::filter {

using Detections = std::optional<std::vector<vision::Detection>>;

/// One answer of the detector: the boxes of the frame with this stamp, perhaps none.
struct DetectorAnswer {
  std::int64_t stamp_ns = 0;
  std::vector<vision::Detection> detections;
};

/// What was heard of the detector since the frame before.
struct DetectorWord {
  bool watching = false;                ///< somebody looks: silence means "not yet"; else geometry only
  std::vector<DetectorAnswer> answers;  ///< new ones by stamp; of this frame or of earlier ones, late ones included
};
/// The boxes of this very frame; empty optional = nobody looks.
DetectorWord word_of(std::int64_t stamp_ns, const Detections& detections);

}  // namespace rtd::filter
