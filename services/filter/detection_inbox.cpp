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

void DetectionInbox::put(StampedDetections detections) {
  {
    const std::lock_guard lock(mutex_);
    by_stamp_[detections.stamp_ns] = std::move(detections.detections);
    while (by_stamp_.size() > kMaxStamps) by_stamp_.erase(by_stamp_.begin());
  }
  arrived_.notify_all();
}

std::optional<StampedDetections> DetectionInbox::wait_for(std::int64_t stamp_ns, const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  while (!closed_ && !by_stamp_.contains(stamp_ns)) {
    arrived_.wait_for(lock, kAskPeriod);
    if (by_stamp_.contains(stamp_ns)) break;
    lock.unlock();
    const bool enough = give_up();
    lock.lock();
    if (enough) break;
  }
  const auto found = by_stamp_.find(stamp_ns);
  if (found == by_stamp_.end()) return std::nullopt;
  StampedDetections result{stamp_ns, found->second};
  by_stamp_.erase(by_stamp_.begin(), found);
  return result;
}

std::optional<StampedDetections> DetectionInbox::newest(std::int64_t stamp_ns, std::int64_t max_age_ns) const {
  const std::lock_guard lock(mutex_);
  auto after = by_stamp_.upper_bound(stamp_ns);
  if (after == by_stamp_.begin()) return std::nullopt;
  --after;
  if (stamp_ns - after->first > max_age_ns) return std::nullopt;
  return StampedDetections{after->first, after->second};
}

void DetectionInbox::clear() {
  const std::lock_guard lock(mutex_);
  by_stamp_.clear();
}

void DetectionInbox::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_all();
}

std::vector<vision::Detection> carry(const StampedDetections& old, std::int64_t stamp_ns, double growth_per_s) {
  const auto growth = static_cast<float>(growth_per_s * static_cast<double>(stamp_ns - old.stamp_ns) * 1e-9);
  std::vector<vision::Detection> carried = old.detections;
  for (vision::Detection& box : carried) {
    box.x_px -= 0.5F * growth * box.width_px;
    box.y_px -= 0.5F * growth * box.height_px;
    box.width_px *= 1.0F + growth;
    box.height_px *= 1.0F + growth;
  }
  return carried;
}

StampedDetections from_message(const msg::Detection2DArray& message) {
  StampedDetections result{msg::to_ns(message.header.stamp), {}};
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
