// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/inboxes.hpp"

namespace rtd::filter {
namespace {

constexpr std::chrono::milliseconds kAskPeriod{50};

constexpr std::size_t kMaxWaiting = 1024;

template <class Map>
void keep_newest(Map& map) {
  while (map.size() > kMaxWaiting) map.erase(map.begin());
}

}  // namespace

void DetectionInbox::put(DetectionBatch batch, std::size_t in_message) {
  const std::lock_guard lock(mutex_);
  boxes_.put(batch.stamp_ns, {std::move(batch.detections), in_message});
  arrived_.notify_all();
}

void DetectionInbox::put(DetectionBatch batch) {
  const std::size_t all = batch.detections.size();
  put(std::move(batch), all);
}

void DetectionInbox::put_masks(std::int64_t stamp_ns, vision::PersonMasks masks) {
  const std::lock_guard lock(mutex_);
  masks_.put(stamp_ns, std::move(masks));
  newest_masks_ns_ = stamp_ns;
  masks_silent_ = false;
  arrived_.notify_all();
}

bool DetectionInbox::wait_for(std::int64_t stamp_ns, const GiveUp& give_up) {
  return wait([&] { return boxes_.has(stamp_ns); }, give_up);
}

bool DetectionInbox::wait_for_masks(std::int64_t stamp_ns, const GiveUp& give_up) {
  const auto decided = [&] { return masks_.has(stamp_ns) || newest_masks_ns_ > stamp_ns || masks_silent_; };
  const bool in_time = wait(decided, give_up);
  const std::lock_guard lock(mutex_);
  if (!in_time) masks_silent_ = true;
  return masks_.has(stamp_ns);
}

/// `done` is asked with the mutex locked.
bool DetectionInbox::wait(const std::function<bool()>& done, const GiveUp& give_up) {
  std::unique_lock lock(mutex_);
  while (!closed_ && !done()) {
    arrived_.wait_for(lock, kAskPeriod);
    if (done()) break;
    lock.unlock();
    const bool enough = give_up();
    lock.lock();
    if (enough) break;
  }
  return done();
}

std::vector<DetectionBatch> DetectionInbox::take_until(std::int64_t stamp_ns) {
  const std::lock_guard lock(mutex_);
  std::vector<DetectionBatch> taken;
  for (auto& [stamp, boxes] : boxes_.take_until(stamp_ns)) {
    DetectionBatch& batch = taken.emplace_back(DetectionBatch{stamp, std::move(boxes.detections)});
    std::optional<vision::PersonMasks> masks = masks_.take(stamp);
    if (masks && boxes.in_message == batch.detections.size()) batch.masks = std::move(*masks);
  }
  return taken;
}

void DetectionInbox::clear() {
  const std::lock_guard lock(mutex_);
  boxes_.clear();
  masks_.clear();
  newest_masks_ns_ = std::numeric_limits<std::int64_t>::min();
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
