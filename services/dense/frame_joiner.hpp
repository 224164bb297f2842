// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "common/msg/rgbd_frame.hpp"
#include "common/msg/tracking.hpp"
#include "services/dense/core/depth_view.hpp"

namespace rtd::dense {

/// A keyframe event of slam; the first one of a restarted slam process is marked.
struct KeyframeUpdate {
  msg::KeyframeEvent event;
  bool new_map = false;
};

/// Everything about one frame that is to be fused.
struct JoinedFrame {
  std::shared_ptr<const msg::FrameView> frame;
  std::optional<DynamicMask> mask;  ///< empty: the filter sent none
  msg::TrackingResult result{};
  std::vector<KeyframeUpdate> updates;  ///< those that slam published up to this frame, in order
};

/// What became of the frames that slam answered.
struct JoinCounters {
  std::uint64_t passed_over = 0;    ///< neither every n-th nor a keyframe
  std::uint64_t not_tracked = 0;    ///< or in another map
  std::uint64_t without_image = 0;  ///< it was dropped before its turn, or never came
  std::uint64_t without_mask = 0;
};

/// Joins images, masks and poses by the stamp of the frame. Filled by bus threads, none of which ever waits; emptied by
/// the worker. Bounded: 12 images, 64 masks, 256 poses; the oldest are dropped first. Thread-safe.
class FrameJoiner {
 public:
  struct Options {
    std::uint64_t every = 5;
    bool needs_masks = true;
  };
  explicit FrameJoiner(const Options& options) : options_(options) {}

  void put(std::shared_ptr<const msg::FrameView> frame);
  void put(std::int64_t stamp_ns, DynamicMask mask);
  void put(const msg::TrackingResult& result);
  void put(const msg::KeyframeEvent& event);
  /// The next frame to fuse, in slam's order; waits for one.
  std::optional<JoinedFrame> take(std::chrono::milliseconds timeout);
  /// Nothing more comes: frames that wait for a missing part are dropped.
  void close();
  /// All updates that were not taken with a frame.
  std::vector<KeyframeUpdate> take_updates();
  JoinCounters counters() const;
  /// The newest pose is in another map than the first, the only one that is fused: `map` is another frame now.
  bool elsewhere() const;

 private:
  enum class Verdict { kReady, kWait, kDone };
  struct StampedMask {
    std::int64_t stamp_ns = 0;
    DynamicMask mask;
  };
  std::optional<JoinedFrame> take_locked();
  Verdict judge(const msg::TrackingResult& result);
  bool wanted(const msg::TrackingResult& result) const;
  JoinedFrame join(const msg::TrackingResult& result);
  void forget(std::int64_t stamp_ns);

  const Options options_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::shared_ptr<const msg::FrameView>> frames_;
  std::deque<StampedMask> masks_;
  std::deque<msg::TrackingResult> results_;
  std::deque<KeyframeUpdate> updates_;
  std::deque<std::uint64_t> keyframe_seqs_;
  std::uint64_t next_event_ = 0;  ///< events 0 .. n-1 have come or never will
  std::optional<std::int64_t> last_stamp_ns_;
  JoinCounters counters_;
  bool elsewhere_ = false, closed_ = false;
};

/// Finds the filter's masks of slam's keyframes: in real time slam names a keyframe when later frames have come.
/// Bounded: the oldest are dropped first. Thread-safe.
class KeyframeMasks {
 public:
  static constexpr std::size_t kRecent = 256;  ///< frames, about 19 kB each

  void put(std::int64_t stamp_ns, const DynamicMask& mask);
  void put(const msg::KeyframeEvent& event);
  /// Those found since the last call, by stamp.
  std::map<std::int64_t, DynamicMask> take();

 private:
  std::mutex mutex_;
  std::map<std::int64_t, DynamicMask> recent_, found_;
  std::set<std::int64_t> awaited_;  ///< keyframes whose masks have not come
};

}  // namespace rtd::dense
