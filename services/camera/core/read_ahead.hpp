// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/concurrency/bounded_queue.hpp"

namespace rtd::camera {

/// What the reading thread hands over with a frame.
struct ReadItem {
  std::optional<SourceFrame> frame;       ///< empty: the source is at its end
  std::vector<SkippedInput> skipped;      ///< left out before this frame
  std::uint64_t passed_over = 0;          ///< frames before this one that pass_over() left unread
  SourceCounters counters;                ///< of the source, after this frame
  std::string error;                      ///< not empty: the source failed; no frame follows
  std::int64_t begin_ns = 0, end_ns = 0;  ///< when it was read, by the clock of the ReadAhead
};

/// Reads a source in its own thread, a few frames ahead, so that decoding overlaps with everything else. The
/// source belongs to that thread until it is joined, but for stop(). The consumer is one thread.
class ReadAhead {
 public:
  /// `max_frames` 0: as many as the source has. `now_ns`: a clock for ReadItem::begin_ns.
  ReadAhead(
      FrameSource& source, std::size_t depth, std::uint64_t max_frames,
      std::function<std::int64_t()> now_ns = [] { return 0; });
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// The next frame, in order; waits for it. Empty after close().
  std::optional<ReadItem> next() { return items_.pop(); }
  /// Frames read and waiting.
  std::size_t waiting() const { return items_.size(); }
  /// Frames older than this need not be read any more. Thread-safe.
  void pass_over(std::int64_t stamp_ns) { oldest_wanted_ns_ = stamp_ns; }
  /// Ends the reading; thread-safe, wakes next().
  void close() {
    source_.stop();
    items_.close();
  }

 private:
  void read_all();
  ReadItem read(std::uint64_t frames_read) const;

  FrameSource& source_;
  concurrency::BoundedQueue<ReadItem> items_;
  std::uint64_t max_frames_;
  const std::function<std::int64_t()> now_ns_;
  std::atomic<std::int64_t> oldest_wanted_ns_{std::numeric_limits<std::int64_t>::min()};
  std::thread thread_;
};

}  // namespace rtd::camera
