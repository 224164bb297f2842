// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/msg/tracking.hpp"
#include "services/slam/core/map/map.hpp"

namespace rtd::slam {

/// When a robot asks an atlas for its place, which answers count, and how long a map that it took has to prove right.
/// All times are stamps of frames. Not thread-safe.
class PlacePolicy {
 public:
  /// Another map: it begins with the next frame, or was loaded.
  void begin_map(bool loaded);
  /// What became of the next frame.
  void update(const msg::TrackingResult& result);
  /// Whether the place is wanted: the map has just begun, or the camera is lost.
  bool wanted() const;
  /// Whether the last frame should be asked about, too.
  bool due() const;
  /// The last frame was asked about.
  void note_query();
  /// Whether a frame that was asked about lately has this stamp.
  bool is_answer(std::int64_t stamp_ns) const;
  /// An answer is the map from now on; its components are numbered below `next_map`.
  void take(MapId next_map);
  /// The map that was taken is not where the camera is: it was not found there in time.
  bool failed() const;
  /// An answer was of no use: nothing is wanted for a while.
  void pause() { paused_ns_ = now_ns_; }

 private:
  bool is_new() const;
  double since_s(std::int64_t stamp_ns) const;

  struct Taken {
    std::int64_t stamp_ns = 0;
    MapId next_map = 0;
    bool elsewhere = false;  ///< the camera has begun a map next to it
  };
  std::int64_t now_ns_ = 0;               ///< stamp of the last frame
  std::optional<std::int64_t> first_ns_;  ///< first frame since the map was forgotten
  std::optional<std::int64_t> begun_ns_;  ///< first of them with a pose
  std::optional<std::int64_t> lost_ns_;   ///< since when the camera is lost
  std::optional<std::int64_t> paused_ns_;
  std::optional<Taken> taken_;        ///< until the camera is found in it
  bool loaded_ = false;               ///< the map is not new, whenever it came
  std::deque<std::int64_t> queries_;  ///< stamps
};

}  // namespace rtd::slam
