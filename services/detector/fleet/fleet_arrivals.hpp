// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"
#include "services/detector/core/fleet/fleet_queue.hpp"

namespace rtd::detector {

/// The images that the robots have sent, for one thread that takes them in turns. Thread-safe.
class FleetArrivals {
 public:
  using Queue = FleetQueue<std::shared_ptr<const msg::CompressedImage>>;

  explicit FleetArrivals(const FleetQueueConfig& config) : queue_(config) {}

  void put(const std::string& robot, std::shared_ptr<const msg::CompressedImage> jpeg);
  /// The next batch; waits for one. Empty once closed.
  std::vector<Queue::Taken> take();
  void remove(const std::string& robot);
  std::uint64_t dropped(const std::string& robot) const;
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Queue queue_;
  bool closed_ = false;
};

}  // namespace rtd::detector
