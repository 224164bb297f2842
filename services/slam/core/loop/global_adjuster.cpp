// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/global_adjuster.hpp"

#include <utility>

namespace rtd::slam {

void GlobalAdjuster::run_in_background(std::function<void()> on_done) {
  background_ = true;
  on_done_ = std::move(on_done);
}

void GlobalAdjuster::start(GlobalProblem problem) {
  cancel();
  cancelled_ = false;
  if (!background_) {
    adjust(std::move(problem));
    return;
  }
  thread_ = std::thread([this, own = std::move(problem)]() mutable {
    adjust(std::move(own));
    if (!cancelled_ && on_done_) on_done_();
  });
}

void GlobalAdjuster::adjust(GlobalProblem problem) {
  GlobalBundleOptions options = options_;
  options.interrupted = [this] { return cancelled_.load(); };
  adjust_globally(problem, options);
  if (cancelled_) return;
  const std::lock_guard lock(mutex_);
  result_ = std::move(problem);
}

void GlobalAdjuster::cancel() {
  cancelled_ = true;
  wait();
  const std::lock_guard lock(mutex_);
  result_.reset();
}

void GlobalAdjuster::wait() {
  if (thread_.joinable()) thread_.join();
}

std::optional<GlobalProblem> GlobalAdjuster::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

}  // namespace rtd::slam
