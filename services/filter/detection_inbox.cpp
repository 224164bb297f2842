// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/detection_inbox.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rtd::filter {
namespace {

constexpr std::size_t kMaxStamps = 64, kMaxBoxes = 300;
constexpr std::chrono::milliseconds kAskPeriod{50};

bool usable(const vision::Detection& box) {
  return std::isfinite(box.score) && std::isfinite(box.x_px) && std::isfinite(box.y_px) &&
         std::isfinite(box.width_px) && std::isfinite(box.height_px) && box.width_px > 0 && box.height_px > 0;
}

}  // namespace

void DetectionInbox::put(DetectorAnswer answer) {
  {
    const std::lock_guard lock(mutex_);
    arrivals_.push_back(answer.stamp_ns);
    by_stamp_[answer.stamp_ns] = std::move(answer.detections);
    while (arrivals_.size() > kMaxStamps) {
      const std::int64_t first = arrivals_.front();
      arrivals_.pop_front();
      if (std::find(arrivals_.begin(), arrivals_.end(), first) == arrivals_.end()) by_stamp_.erase(first);
    }
  }
  arrived_.notify_all();
}

bool DetectionInbox::wait_for(std::int64_t stamp_ns, const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  while (!closed_ && !by_stamp_.contains(stamp_ns)) {
    arrived_.wait_for(lock, kAskPeriod);
    if (by_stamp_.contains(stamp_ns)) break;
    lock.unlock();
    const bool enough = give_up();
    lock.lock();
    if (enough) break;
  }
  return by_stamp_.contains(stamp_ns);
}

std::vector<DetectorAnswer> DetectionInbox::take_until(std::int64_t stamp_ns) {
  const std::lock_guard lock(mutex_);
  const auto end = by_stamp_.upper_bound(stamp_ns);
  std::vector<DetectorAnswer> taken;
  for (auto it = by_stamp_.begin(); it != end; ++it) taken.push_back({it->first, std::move(it->second)});
  by_stamp_.erase(by_stamp_.begin(), end);
  return taken;
}

void DetectionInbox::clear() {
  const std::lock_guard lock(mutex_);
  by_stamp_.clear();
  arrivals_.clear();
}

void DetectionInbox::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_all();
}

DetectorAnswer from_message(const msg::Detection2DArray& message) {
  DetectorAnswer result{msg::to_ns(message.header.stamp), {}};
  for (const msg::Detection2D& detection : message.detections) {
    if (detection.results.empty()) continue;
    const auto best =
        std::max_element(detection.results.begin(), detection.results.end(),
                         [](const auto& a, const auto& b) { return a.hypothesis.score < b.hypothesis.score; });
    const msg::BoundingBox2D& box = detection.bbox;
    const vision::Detection converted{best->hypothesis.class_id,
                                      static_cast<float>(best->hypothesis.score),
                                      static_cast<float>(box.center.position.x - box.size_x / 2),
                                      static_cast<float>(box.center.position.y - box.size_y / 2),
                                      static_cast<float>(box.size_x),
                                      static_cast<float>(box.size_y)};
    if (usable(converted)) result.detections.push_back(converted);
  }
  if (result.detections.size() > kMaxBoxes) {
    std::stable_sort(result.detections.begin(), result.detections.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    result.detections.resize(kMaxBoxes);
  }
  return result;
}

}  // namespace rtd::filter
