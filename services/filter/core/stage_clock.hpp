// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

namespace rtd::filter {

/// Time of consecutive stages from an injected clock.
class StageClock {
 public:
  explicit StageClock(const std::function<std::int64_t()>& now_ns) : now_ns_(now_ns), last_ns_(now_ns()) {}
  /// Milliseconds since construction or the last lap.
  float lap_ms() {
    const std::int64_t before_ns = last_ns_;
    last_ns_ = now_ns_();
    return static_cast<float>(last_ns_ - before_ns) * 1e-6F;
  }

 private:
  const std::function<std::int64_t()>& now_ns_;
  std::int64_t last_ns_;
};

}  // namespace rtd::filter
