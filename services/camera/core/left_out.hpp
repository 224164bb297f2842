// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/camera/frame_source.hpp"
#include "services/camera/core/read_ahead.hpp"

namespace rtd::camera {

/// Counts the frames that a source had and that slam cannot use: those that the source left out, and those without a
/// depth that slam may use. Not thread-safe.
class LeftOut {
 public:
  /// `all`: frames that the source expects, 0 = unknown; `most`: to be played, 0 = all; `at_opening`: its counters once
  /// it is open. A list is read as a whole then, so of what was left out the share counts that has been played.
  void open(std::uint64_t all, std::uint64_t most, const SourceCounters& at_opening);
  /// An earlier process has played so many frames, and this one has met `passed` on the way behind them.
  void resume(std::uint64_t frames, const SourceCounters& passed);
  void add(const ReadItem& item);
  void add(const vision::RgbdImage& image);

  /// What was left out of the part that was played, of which the source has given `frames_in` frames.
  SourceCounters counters(std::uint64_t frames_in) const;
  /// The same as numbers for the heartbeat, and the frames given whose depth is nowhere between 0.1 and 20 m, as with a
  /// wrong unit.
  std::map<std::string, std::uint64_t> metrics(std::uint64_t frames_in) const;
  /// The first piece that was left out, for people; empty when there is none.
  const std::string& first() const { return first_; }

 private:
  std::uint64_t all_ = 0, most_ = 0, before_ = 0, out_of_range_ = 0;
  SourceCounters at_opening_, passed_, now_;
  std::string first_;
  bool ended_ = false;
};

}  // namespace rtd::camera
