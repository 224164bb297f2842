// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/roll_feedback.hpp"

namespace rtd::detector {

void RollFeedback::put(const msg::TrackingResult& result) {
  {
    const std::lock_guard lock(mutex_);
    roll_.on_tracking(result);
    newest_ns_ = result.stamp_ns;
  }
  heard_.notify_all();
}

double RollFeedback::roll_rad() const {
  const std::lock_guard lock(mutex_);
  return roll_.roll_rad();
}

bool RollFeedback::wait_for(std::int64_t stamp_ns, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return heard_.wait_for(lock, timeout, [&] { return closed_ || newest_ns_ >= stamp_ns; }) && !closed_;
}

void RollFeedback::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  heard_.notify_all();
}

}  // namespace rtd::detector
