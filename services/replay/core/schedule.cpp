// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

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

void TimingError::add(std::int64_t due_ns, std::int64_t sent_ns) {
  if (any_) {
    const std::int64_t error_ns = std::abs((sent_ns - last_sent_ns_) - (due_ns - last_due_ns_));
    ++bins_[std::min(static_cast<std::size_t>(error_ns / kBinNs), kBins - 1)];
    ++count_;
    max_ns_ = std::max(max_ns_, error_ns);
  }
  last_due_ns_ = due_ns;
  last_sent_ns_ = sent_ns;
  any_ = true;
}

double TimingError::percentile_ms(double percent) const {
  const auto rank = static_cast<std::uint64_t>(percent / 100 * static_cast<double>(count_));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin];
    if (seen > rank || (seen == count_ && count_ > 0)) return static_cast<double>((bin + 1) * kBinNs) * 1e-6;
  }
  return 0;
}

}  // namespace rtd::replay
