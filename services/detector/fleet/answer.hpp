// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/vision/detection.hpp"

namespace rtd::detector {

/// An answer and what it was computed from.
struct Answer {
  std::int64_t stamp_ns = 0;    ///< of the image
  std::int64_t arrived_ns = 0;  ///< CLOCK_MONOTONIC
  std::size_t batch = 0;        ///< images computed together
  std::vector<vision::Detection> detections;
};

}  // namespace rtd::detector
