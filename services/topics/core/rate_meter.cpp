// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/core/rate_meter.hpp"

#include <algorithm>
#include <cmath>

namespace rtd::topics {

void RateMeter::add(std::int64_t received_ns, std::size_t bytes) {
  bytes_ += bytes;
  if (messages_++ > 0) {
    const std::int64_t period_ns = std::max<std::int64_t>(0, received_ns - last_ns_);  // two writers may overtake
    const auto periods = static_cast<double>(messages_ - 1);
    const double from_mean = static_cast<double>(period_ns) - mean_ns_;
    mean_ns_ += from_mean / periods;
    squares_ns2_ += from_mean * (static_cast<double>(period_ns) - mean_ns_);
    shortest_ns_ = messages_ == 2 ? period_ns : std::min(shortest_ns_, period_ns);
    longest_ns_ = std::max(longest_ns_, period_ns);
  }
  last_ns_ = received_ns;
}

Rate RateMeter::rate() const {
  Rate rate{messages_, bytes_, lost_};
  if (messages_ < 2) return rate;
  const auto periods = static_cast<double>(messages_ - 1);
  rate.hz = mean_ns_ > 0 ? 1e9 / mean_ns_ : 0;
  rate.mean_ms = mean_ns_ * 1e-6;
  rate.deviation_ms = std::sqrt(squares_ns2_ / periods) * 1e-6;
  rate.shortest_ms = static_cast<double>(shortest_ns_) * 1e-6;
  rate.longest_ms = static_cast<double>(longest_ns_) * 1e-6;
  return rate;
}

}  // namespace rtd::topics
