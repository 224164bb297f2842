// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "common/msg/ros.hpp"
#include "common/vision/detection.hpp"

namespace rtd::filter {

/// Boxes of one image.
struct StampedDetections {
  std::int64_t stamp_ns = 0;
  std::vector<vision::Detection> detections;
};

/// Pairs detections with frames by stamp. Filled by a bus thread, read by the worker. Thread-safe, bounded.
class DetectionInbox {
 public:
  void put(StampedDetections detections);
  /// The boxes of exactly this stamp; waits until they come, `give_up()` says so (asked every 50 ms) or the inbox is
  /// closed. What is older is forgotten.
  std::optional<StampedDetections> wait_for(std::int64_t stamp_ns, const std::function<bool()>& give_up);
  /// The newest boxes that are not newer than `stamp_ns`, at most `max_age_ns` old.
  std::optional<StampedDetections> newest(std::int64_t stamp_ns, std::int64_t max_age_ns) const;
  /// Time went backwards: what is here belongs to another story.
  void clear();
  void close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<std::int64_t, std::vector<vision::Detection>> by_stamp_;
  bool closed_ = false;
};

/// Boxes of an older image for a newer one: the same boxes, grown by `growth_per_s` of their size per second of age,
/// since the object has moved meanwhile; the mask is cut from the current depth image.
std::vector<vision::Detection> carry(const StampedDetections& old, std::int64_t stamp_ns, double growth_per_s);

/// Best hypothesis of every box; boxes without one, with numbers that are not finite or without area are left out,
/// of more than 300 the best are kept.
StampedDetections from_message(const msg::Detection2DArray& message);

}  // namespace rtd::filter
