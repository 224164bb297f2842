// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/schedule.hpp"

#include <cmath>

namespace rtd::replay {

void Schedule::jump(std::int64_t recorded_ns, std::int64_t now_ns) {
  anchor_recorded_ns_ = recorded_ns;
  anchor_ns_ = now_ns;
}

void Schedule::pause(std::int64_t now_ns) {
  jump(recorded_ns(now_ns), now_ns);
  paused_ = true;
}

void Schedule::resume(std::int64_t now_ns) {
  anchor_ns_ = now_ns;
  paused_ = false;
}

void Schedule::set_rate(double rate, std::int64_t now_ns) {
  jump(recorded_ns(now_ns), now_ns);
  rate_ = rate;
}

std::int64_t Schedule::due_ns(std::int64_t recorded_ns) const {
  return anchor_ns_ + std::llround(static_cast<double>(recorded_ns - anchor_recorded_ns_) / rate_);
}

std::int64_t Schedule::recorded_ns(std::int64_t now_ns) const {
  if (paused_) return anchor_recorded_ns_;
  return anchor_recorded_ns_ + std::llround(static_cast<double>(now_ns - anchor_ns_) * rate_);
}

}  // namespace rtd::replay
