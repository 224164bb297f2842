// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace rtd::camera {

/// Watches what a device delivers for faults that leave it running: an image that stands still, depth without
/// measurements, frames that are lost. Times are the host's, ns. Not thread-safe.
class DeviceHealth {
 public:
  /// The device starts now, at a nominal rate in Hz.
  void restart(std::int64_t now_ns, double fps);
  void note_color(std::int64_t now_ns, const std::vector<std::uint8_t>& bytes);
  void note_frame(std::int64_t now_ns, bool has_depth);

  /// The same bytes for a second. Noise changes every image of a sensor, in the dark too.
  bool frozen(std::int64_t now_ns) const;
  /// What is wrong with the frames that come, with likely causes; empty when nothing is.
  std::string fault(std::int64_t now_ns) const;

 private:
  std::string lost_frames(std::int64_t now_ns) const;

  double fps_ = 0;
  std::int64_t started_ns_ = 0, color_changed_ns_ = 0, depth_seen_ns_ = 0;
  std::optional<std::size_t> color_hash_;
  std::deque<std::int64_t> frames_ns_;  ///< of the last two seconds
};

}  // namespace rtd::camera
