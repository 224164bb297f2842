// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/frame_source.hpp"

#include <numeric>

namespace rtd::camera {

const char* to_string(SkipReason reason) {
  switch (reason) {
    case SkipReason::kMalformedLine:
      return "malformed_line";
    case SkipReason::kNoDepthPartner:
      return "no_depth_partner";
    case SkipReason::kStampBackwards:
      return "stamp_backwards";
    case SkipReason::kStampDoubled:
      return "stamp_doubled";
    case SkipReason::kColorUnreadable:
      return "color_unreadable";
    case SkipReason::kDepthUnreadable:
      return "depth_unreadable";
    case SkipReason::kDepthNot16Bit:
      return "depth_not_16_bit";
    case SkipReason::kSizeMismatch:
      return "size_mismatch";
    case SkipReason::kDamagedRecord:
      return "damaged_record";
    case SkipReason::kOverrun:
      return "overrun";
  }
  return "unknown";
}

std::uint64_t SourceCounters::skipped_total() const {
  return std::accumulate(skipped.begin(), skipped.end(), std::uint64_t{0});
}

}  // namespace rtd::camera
