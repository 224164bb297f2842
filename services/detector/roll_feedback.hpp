// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "services/detector/core/camera_roll.hpp"

namespace rtd::detector {

/// The camera's roll as slam tells it, between the thread that hears it and those that detect. Thread-safe.
class RollFeedback {
 public:
  explicit RollFeedback(const RollConfig& config) : roll_(config) {}

  void put(const msg::TrackingResult& result);
  /// Of the newest pose.
  double roll_rad() const;
  /// Waits until slam has answered the image of `stamp_ns` or a later one. False: it has not within the timeout.
  bool wait_for(std::int64_t stamp_ns, std::chrono::milliseconds timeout);
  /// Ends all waiting.
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable heard_;
  CameraRoll roll_;
  std::int64_t newest_ns_ = INT64_MIN;
  bool closed_ = false;
};

}  // namespace rtd::detector
