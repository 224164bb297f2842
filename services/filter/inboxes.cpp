// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/inboxes.hpp"

#include <algorithm>
#include <utility>

namespace rtd::filter {
namespace {

constexpr std::size_t kMaxStamps = 64;
constexpr std::chrono::milliseconds kAskPeriod{50};

constexpr std::size_t kMaxWaiting = 1024;

template <class Map>
void keep_newest(Map& map) {
  while (map.size() > kMaxWaiting) map.erase(map.begin());
}

}  // namespace

void DetectionInbox::put(DetectionBatch batch) {
  const std::lock_guard lock(mutex_);
  arrivals_.push_back(batch.stamp_ns);
  by_stamp_[batch.stamp_ns] = std::move(batch.detections);
  while (arrivals_.size() > kMaxStamps) {
    const std::int64_t first = arrivals_.front();
    arrivals_.pop_front();
    if (std::find(arrivals_.begin(), arrivals_.end(), first) == arrivals_.end()) by_stamp_.erase(first);
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

std::vector<DetectionBatch> DetectionInbox::take_until(std::int64_t stamp_ns) {
  const std::lock_guard lock(mutex_);
  const auto end = by_stamp_.upper_bound(stamp_ns);
  std::vector<DetectionBatch> taken;
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
  const std::lock_guard lock(mutex_);
  closed_ = true;
  arrived_.notify_all();
}

void SlamFeedback::put(const msg::TrackingResult& result) {
  const std::lock_guard lock(mutex_);
  results_[result.seq] = result;
  newest_ = result;
  keep_newest(results_);
  arrived_.notify_all();
}

void SlamFeedback::put(const msg::KeyframeEvent& event) {
  const std::lock_guard lock(mutex_);
  events_[event.event_index] = event;
  events_received_ = event.event_index + 1;  // one writer, reliable and in order; a restarted slam counts from 0 again
  keep_newest(events_);
  arrived_.notify_all();
}

bool SlamFeedback::complete(std::uint64_t seq) const {
  return newest_ && newest_->seq == seq && events_received_ >= newest_->event_count;
}

SlamUpdate SlamFeedback::take_locked(bool complete) {
  SlamUpdate update;
  update.complete = complete;
  for (const auto& [index, event] : events_) update.events.push_back(event);
  for (const auto& [seq, result] : results_) update.results.push_back(result);
  events_.clear();
  results_.clear();
  return update;
}

SlamUpdate SlamFeedback::take() {
  const std::lock_guard lock(mutex_);
  return take_locked(true);
}

SlamUpdate SlamFeedback::take_after(std::uint64_t seq, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, timeout, [&] { return closed_ || complete(seq); });
  return take_locked(complete(seq));
}

bool SlamFeedback::wait_for(std::uint64_t seq, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return arrived_.wait_for(lock, timeout, [&] { return closed_ || complete(seq); });
}

void SlamFeedback::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  arrived_.notify_all();
}

}  // namespace rtd::filter
