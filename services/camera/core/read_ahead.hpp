// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/concurrency/bounded_queue.hpp"
#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// What the reading thread hands over with a frame.
struct ReadItem {
  std::optional<SourceFrame> frame;   ///< empty: the source is at its end
  std::vector<SkippedInput> skipped;  ///< left out before this frame
  SourceCounters counters;            ///< of the source, after this frame
  std::string error;                  ///< not empty: the source failed; no frame follows
};

/// Reads a source in a thread of its own, a few frames ahead, so that decoding overlaps with everything else. The
/// source belongs to that thread until it is joined. The consumer is one thread.
class ReadAhead {
 public:
  /// `max_frames` 0: as many as the source has.
  ReadAhead(FrameSource& source, std::size_t depth, std::uint64_t max_frames);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// The next frame, in order; waits for it. Empty after close().
  std::optional<ReadItem> next() { return items_.pop(); }
  /// Ends the reading; thread-safe, wakes next().
  void close() { items_.close(); }

 private:
  ReadItem read(FrameSource& source, std::uint64_t frames_read) const;

  concurrency::BoundedQueue<ReadItem> items_;
  std::uint64_t max_frames_;
  std::thread thread_;
};

}  // namespace rtd::camera
