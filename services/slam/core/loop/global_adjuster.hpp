// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "services/slam/core/loop/global_bundle_adjustment.hpp"

namespace rtd::slam {

/// Adjusts copies of the map, in the caller's thread or in one of its own. start(), wait() and take(): one thread.
class GlobalAdjuster {
 public:
  explicit GlobalAdjuster(GlobalBundleOptions options) : options_(std::move(options)) {}
  ~GlobalAdjuster() { cancel(); }
  GlobalAdjuster(const GlobalAdjuster&) = delete;
  GlobalAdjuster& operator=(const GlobalAdjuster&) = delete;

  /// From now on in a thread of its own, which calls `on_done` when a result waits to be taken.
  void run_in_background(std::function<void()> on_done);
  /// Gives up what is running.
  void start(GlobalProblem problem);
  void cancel();
  /// Waits for what is running.
  void wait();
  /// The adjusted copy, once.
  std::optional<GlobalProblem> take();

 private:
  void adjust(GlobalProblem problem);

  GlobalBundleOptions options_;
  bool background_ = false;
  std::function<void()> on_done_;
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;  ///< guards the result
  std::optional<GlobalProblem> result_;
  std::thread thread_;
};

}  // namespace rtd::slam
