// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rtd::camera {

/// The last frame that an earlier process of a camera gave: the next one continues behind it.
struct ResumePoint {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0, published_ns = 0;  ///< published_ns: CLOCK_MONOTONIC
};

/// "SEQ,STAMP_NS,PUBLISHED_NS"; empty when the text is not that.
std::optional<ResumePoint> parse_resume_point(const std::string& text);

}  // namespace rtd::camera
