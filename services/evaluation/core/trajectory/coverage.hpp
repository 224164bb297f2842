// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rtd::eval {

/// A time without poses.
struct LostSpan {
  std::int64_t first_ns = 0;  ///< frame list: first frame without pose; ground truth: last pose before the gap
  std::int64_t last_ns = 0;   ///< frame list: last frame without pose; ground truth: first pose behind the gap
  std::size_t frames = 0;     ///< frames without pose; 0 when no frame list is known

  double duration_s() const { return static_cast<double>(last_ns - first_ns) * 1e-9; }
};

/// How much of a sequence has poses.
struct Coverage {
  double fraction = 0;     ///< [0, 1]
  std::size_t frames = 0;  ///< length of the frame list; 0 when measured against the ground truth's span
  std::size_t tracked = 0;
  std::vector<LostSpan> lost;
};

/// Frames with a pose over all frames; a frame has a pose when one lies within 1 ms. Stamps in increasing order.
Coverage coverage_of_frames(const std::vector<std::int64_t>& frames_ns, const std::vector<std::int64_t>& poses_ns);

/// Time covered over the time from `first_ns` to `last_ns` (the ground truth's span): neighbouring poses, and the two
/// ends, cover what lies between them unless they are further apart than max_gap_s. Stamps in increasing order.
Coverage coverage_of_span(std::int64_t first_ns, std::int64_t last_ns, const std::vector<std::int64_t>& poses_ns,
                          double max_gap_s);

}  // namespace rtd::eval
