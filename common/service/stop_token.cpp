// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/stop_token.hpp"

#include <utility>

namespace rtd::service {

void StopToken::request_stop() {
  std::vector<std::function<void()>> actions;
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    stopped_ = true;
    actions.swap(actions_);
  }
  changed_.notify_all();
  for (const auto& action : actions) action();
}

bool StopToken::stop_requested() const {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

bool StopToken::wait_for(std::chrono::nanoseconds duration) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, duration, [this] { return stopped_; });
}

void StopToken::on_stop(std::function<void()> action) {
  {
    const std::lock_guard lock(mutex_);
    if (!stopped_) {
      actions_.push_back(std::move(action));
      return;
    }
  }
  action();
}

}  // namespace rtd::service
