// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/timing.hpp"

#include <algorithm>

namespace rtd::recording {

Timing timing_of(std::vector<mcap::Timestamp> times_ns) {
  Timing timing;
  timing.messages = times_ns.size();
  if (times_ns.empty()) return timing;
  std::ranges::sort(times_ns);
  timing.first_ns = times_ns.front();
  timing.last_ns = times_ns.back();
  std::vector<std::uint64_t> periods_ns;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    periods_ns.push_back(times_ns[i] - times_ns[i - 1]);
    if (periods_ns.back() <= timing.largest_gap_ns) continue;
    timing.largest_gap_ns = periods_ns.back();
    timing.largest_gap_at_ns = times_ns[i - 1];
  }
  if (timing.first_ns == timing.last_ns) return timing;
  timing.rate_hz = static_cast<double>(periods_ns.size()) * 1e9 / static_cast<double>(timing.last_ns - timing.first_ns);
  const auto middle = periods_ns.begin() + static_cast<std::ptrdiff_t>(periods_ns.size() / 2);
  std::ranges::nth_element(periods_ns, middle);
  timing.median_period_ns = *middle;
  const double longest_ns = kGapPeriods * static_cast<double>(timing.median_period_ns);
  timing.gaps = static_cast<std::uint64_t>(std::ranges::count_if(
      periods_ns, [&](std::uint64_t period) { return static_cast<double>(period) > longest_ns; }));
  return timing;
}

void SequenceCount::add(std::uint32_t sequence) {
  numbered_ = numbered_ || sequence != 0;
  if (any_ && sequence > last_ + 1) {
    ++gaps_;
    missing_ += sequence - last_ - 1;
  }
  if (any_ && sequence <= last_) ++restarts_;
  last_ = sequence;
  any_ = true;
}

}  // namespace rtd::recording
