// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/load/load_watch.hpp"

#include <algorithm>
#include <utility>

namespace rtd::filter {
namespace {

constexpr double kSmoothing = 0.1;

}  // namespace

void LoadWatch::stood_still(std::int64_t now_ns) {
  constexpr std::int64_t kRareNs = 1'000'000'000;
  if (now_ns - std::exchange(stood_still_ns_, now_ns) < kRareNs) return;
  excused_ns_ = now_ns + static_cast<std::int64_t>(1e9 * limits_.settle_s);
}

bool LoadWatch::add(std::uint64_t seq, double latency_ms, std::int64_t now_ns) {
  if (now_ns - static_cast<std::int64_t>(1e6 * latency_ms) < excused_ns_) {
    last_seq_ = seq;
    return false;
  }
  const std::uint64_t missing = last_seq_ && seq > *last_seq_ ? seq - *last_seq_ - 1 : 0;
  const bool paused = !last_seq_ || seq <= *last_seq_ || missing > static_cast<std::uint64_t>(limits_.window);
  last_seq_ = seq;
  if (paused) {
    recent_.clear();
    smooth_latency_ms_ = latency_ms;
    calm_since_ns_ = now_ns;
    return false;
  }
  smooth_latency_ms_ += kSmoothing * (latency_ms - smooth_latency_ms_);
  recent_.insert(recent_.end(), missing, true);
  recent_.push_back(latency_ms > limits_.max_latency_ms);
  while (recent_.size() > static_cast<std::size_t>(limits_.window)) recent_.pop_front();
  if (missing > 0 || smooth_latency_ms_ > limits_.easy_latency_ms) calm_since_ns_ = now_ns;
  if (now_ns < settled_ns_) {
    recent_.clear();
    return false;
  }
  if (std::ranges::count(recent_, true) > limits_.max_burdened) return shed(now_ns);
  return take_back(now_ns);
}

bool LoadWatch::shed(std::int64_t now_ns) {
  burdened_ = static_cast<int>(std::ranges::count(recent_, true));
  recent_.clear();
  calm_since_ns_ = now_ns;
  settled_ns_ = now_ns + static_cast<std::int64_t>(1e9 * limits_.settle_s);
  if (step_ == steps_) return false;
  const bool too_early = taken_back_ns_ > 0 && static_cast<double>(now_ns - taken_back_ns_) < 2e9 * calm_s_;
  if (step_ == 0 && !too_early) calm_s_ = limits_.calm_s;
  if (too_early) calm_s_ = std::min(2 * calm_s_, limits_.longest_calm_s);
  ++step_;
  return true;
}

bool LoadWatch::take_back(std::int64_t now_ns) {
  if (step_ == 0 || static_cast<double>(now_ns - calm_since_ns_) < 1e9 * calm_s_) return false;
  burdened_ = 0;
  recent_.clear();
  calm_since_ns_ = taken_back_ns_ = now_ns;
  --step_;
  return true;
}

}  // namespace rtd::filter
