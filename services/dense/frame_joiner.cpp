// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/frame_joiner.hpp"

#include <algorithm>
#include <utility>

namespace rtd::dense {
namespace {

constexpr std::size_t kFrames = 12, kMasks = 64, kResults = 256, kWords = 8192, kKeyframes = 64;
constexpr std::size_t kPatience = 4;  // newer poses that a frame waits through for its missing part

template <class Queue>
void keep_newest(Queue& queue, std::size_t count) {
  while (queue.size() > count) queue.pop_front();
}

template <class Queue>
auto with_stamp(Queue& queue, std::int64_t stamp_ns) {
  return std::find_if(queue.begin(), queue.end(), [stamp_ns](const auto& item) {
    if constexpr (requires { item->stamp_ns; }) {
      return item->stamp_ns == stamp_ns;
    } else {
      return item.stamp_ns == stamp_ns;
    }
  });
}

}  // namespace

void FrameJoiner::put(std::shared_ptr<const msg::FrameView> frame) {
  const std::lock_guard lock(mutex_);
  if (with_stamp(frames_, frame->stamp_ns) != frames_.end()) return;  // sent again
  frames_.push_back(std::move(frame));
  keep_newest(frames_, kFrames);
  arrived_.notify_one();
}

void FrameJoiner::put(std::int64_t stamp_ns, DynamicMask mask) {
  const std::lock_guard lock(mutex_);
  masks_.push_back({stamp_ns, std::move(mask)});
  keep_newest(masks_, kMasks);
  arrived_.notify_one();
}

void FrameJoiner::put(const msg::TrackingResult& result) {
  const std::lock_guard lock(mutex_);
  if (with_stamp(results_, result.stamp_ns) != results_.end() || last_stamp_ns_ == result.stamp_ns) return;
  results_.push_back(result);
  if (msg::is_measured(result.state)) elsewhere_ = !msg::is_measured_in_map(result);
  if (results_.size() > kResults) ++counters_.without_image;
  keep_newest(results_, kResults);
  arrived_.notify_one();
}

/// One writer, reliable and in order: an index that goes back comes from a restarted slam process.
void FrameJoiner::put(const msg::KeyframeEvent& event) {
  const std::lock_guard lock(mutex_);
  const bool new_map = event.event_index < next_event_;
  if (new_map) updates_.clear();
  next_event_ = event.event_index + 1;
  updates_.push_back({event, new_map});
  keep_newest(updates_, kWords);
  if (event.kind == msg::KeyframeEventKind::kCreated) keyframe_seqs_.push_back(event.frame_seq);
  keep_newest(keyframe_seqs_, kKeyframes);
  arrived_.notify_one();
}

std::optional<JoinedFrame> FrameJoiner::take(std::chrono::milliseconds timeout) {
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  std::unique_lock lock(mutex_);
  std::optional<JoinedFrame> joined = take_locked();
  while (!joined && !closed_ && arrived_.wait_until(lock, give_up) == std::cv_status::no_timeout) {
    joined = take_locked();
  }
  return joined;
}

std::optional<JoinedFrame> FrameJoiner::take_locked() {
  while (!results_.empty()) {
    const msg::TrackingResult result = results_.front();
    const Verdict verdict = judge(result);
    if (verdict == Verdict::kWait) return std::nullopt;
    results_.pop_front();
    last_stamp_ns_ = result.stamp_ns;
    std::optional<JoinedFrame> joined;
    if (verdict == Verdict::kReady) joined = join(result);
    forget(result.stamp_ns);
    if (joined) return joined;
  }
  return std::nullopt;
}

/// Ready, to be waited for, or done with (and counted).
FrameJoiner::Verdict FrameJoiner::judge(const msg::TrackingResult& result) {
  const bool may_wait = !closed_ && results_.size() <= kPatience;
  const auto done = [](std::uint64_t& counter) {
    ++counter;
    return Verdict::kDone;
  };
  if (!msg::is_measured_in_map(result)) return done(counters_.not_tracked);
  if (next_event_ < result.event_count && may_wait) return Verdict::kWait;
  if (!wanted(result)) return done(counters_.passed_over);
  const bool has_image = with_stamp(frames_, result.stamp_ns) != frames_.end();
  const bool has_mask = with_stamp(masks_, result.stamp_ns) != masks_.end();
  if (!(has_image && has_mask) && may_wait) return Verdict::kWait;
  if (!has_image) return done(counters_.without_image);
  if (!has_mask && options_.needs_masks) return done(counters_.without_mask);
  return Verdict::kReady;
}

bool FrameJoiner::wanted(const msg::TrackingResult& result) const {
  return result.seq % options_.every == 0 ||
         std::find(keyframe_seqs_.begin(), keyframe_seqs_.end(), result.seq) != keyframe_seqs_.end();
}

JoinedFrame FrameJoiner::join(const msg::TrackingResult& result) {
  JoinedFrame joined;
  joined.frame = *with_stamp(frames_, result.stamp_ns);
  joined.result = result;
  if (const auto mask = with_stamp(masks_, result.stamp_ns); mask != masks_.end()) joined.mask = std::move(mask->mask);
  while (!updates_.empty() && updates_.front().event.event_index < result.event_count) {
    joined.updates.push_back(updates_.front());
    updates_.pop_front();
  }
  return joined;
}

void FrameJoiner::forget(std::int64_t stamp_ns) {
  if (const auto frame = with_stamp(frames_, stamp_ns); frame != frames_.end()) frames_.erase(frame);
  if (const auto mask = with_stamp(masks_, stamp_ns); mask != masks_.end()) masks_.erase(mask);
}

void FrameJoiner::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  arrived_.notify_all();
}

std::vector<KeyframeUpdate> FrameJoiner::take_updates() {
  const std::lock_guard lock(mutex_);
  std::vector<KeyframeUpdate> updates(updates_.begin(), updates_.end());
  updates_.clear();
  return updates;
}

bool FrameJoiner::elsewhere() const {
  const std::lock_guard lock(mutex_);
  return elsewhere_;
}

JoinCounters FrameJoiner::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void KeyframeMasks::put(std::int64_t stamp_ns, const DynamicMask& mask) {
  const std::lock_guard lock(mutex_);
  (awaited_.erase(stamp_ns) > 0 ? found_ : recent_).insert_or_assign(stamp_ns, mask);
  if (recent_.size() > kRecent) recent_.erase(recent_.begin());
}

void KeyframeMasks::put(const msg::KeyframeEvent& event) {
  if (event.kind != msg::KeyframeEventKind::kCreated) return;
  const std::lock_guard lock(mutex_);
  if (auto mask = recent_.extract(event.stamp_ns)) {
    found_.insert(std::move(mask));
  } else {
    awaited_.insert(event.stamp_ns);
    if (awaited_.size() > kRecent) awaited_.erase(awaited_.begin());
  }
}

std::map<std::int64_t, DynamicMask> KeyframeMasks::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(found_, {});
}

}  // namespace rtd::dense
