// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "services/slam/core/map/map.hpp"
#include "services/slam/core/optimize/bundle_adjustment.hpp"

namespace rtd::slam {

/// A copy of one component that can be adjusted while the map grows on; docs/theory/loop_closing.md, "Global bundle
/// adjustment". Holds no reference to the map.
struct GlobalProblem {
  BundleProblem bundle;
  MapId component = 0;
  std::vector<KeyframeId> keyframes;  ///< per camera, ascending
  std::vector<LandmarkId> landmarks;  ///< per point; those that at least two keyframes see
};

GlobalProblem copy_global_problem(const Map& map, MapId component);

struct GlobalBundleOptions {
  int iterations = 10;
  int threads = 1;
  std::function<bool()> interrupted;  ///< polled between iterations; if true, the result must not be applied
};
BundleSummary adjust_globally(GlobalProblem& problem, const GlobalBundleOptions& options);

/// Applies an adjusted copy. Newer keyframes follow their parents, newer landmarks their reference keyframe; what was
/// removed since is skipped.
void apply_global_problem(Map& map, const GlobalProblem& problem);

/// Adjusts copies of the map, in the caller's thread or in one of its own. start(), wait() and take(): one thread.
class GlobalAdjuster {
 public:
  explicit GlobalAdjuster(GlobalBundleOptions options) : options_(std::move(options)) {}
  ~GlobalAdjuster() { cancel(); }
  GlobalAdjuster(const GlobalAdjuster&) = delete;
  GlobalAdjuster& operator=(const GlobalAdjuster&) = delete;

  /// From now on in its own thread, which calls `on_done` when a result waits to be taken.
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
