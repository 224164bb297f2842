// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "common/msg/features.hpp"

namespace rtd::filter {

/// Milliseconds by msg::FilterStage.
using StageTimes = std::array<float, msg::kFilterStages>;

/// Measures consecutive stages with an injected clock.
class StageClock {
 public:
  explicit StageClock(const std::function<std::int64_t()>& now_ns) : now_ns_(now_ns), last_ns_(now_ns()) {}
  /// Adds the time since construction or the last call to this stage.
  void finish(msg::FilterStage stage) {
    const std::int64_t before_ns = last_ns_;
    last_ns_ = now_ns_();
    times_ms_[stage] += static_cast<float>(last_ns_ - before_ns) * 1e-6F;
  }
  const StageTimes& times_ms() const { return times_ms_; }

 private:
  const std::function<std::int64_t()>& now_ns_;
  std::int64_t last_ns_;
  StageTimes times_ms_{};
};

}  // namespace rtd::filter
