// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace rtd::camera {

/// Puts the stamps of a device, whose clock may begin anywhere and jump, on the host's clock: differences of stamps
/// stay those of the device, and no stamp is older than one before, over restarts of the device too. All times in ns.
class DeviceTimeline {
 public:
  /// The next image begins the device's time again.
  void restart() { offset_ns_.reset(); }

  /// Takes note of an image that came at now_ns. Returns by how much the device's clock has jumped, 0 = not at all. An
  /// image that is late (a program that was stopped, a full bus) is no jump; an image from the future or more than
  /// kJumpNs older than the one before is.
  std::int64_t note(std::int64_t stamp_ns, std::int64_t now_ns) {
    const bool begins = !offset_ns_;
    const std::int64_t early_ns = begins ? 0 : host_ns(stamp_ns) - now_ns;
    const bool back = !begins && stamp_ns < newest_ns_ - kJumpNs;
    const std::int64_t jump_ns = back ? stamp_ns - newest_ns_ : early_ns > kJumpNs ? early_ns : 0;
    if (begins || jump_ns != 0) offset_ns_ = std::max(now_ns, newest_host_ns_ + kStepNs) - stamp_ns;
    if (!begins && jump_ns == 0 && early_ns > 0) *offset_ns_ -= std::min(early_ns, kSlideNs);
    newest_ns_ = stamp_ns;
    newest_host_ns_ = std::max(newest_host_ns_, host_ns(stamp_ns));
    return jump_ns;
  }

  /// The host's time of a stamp; after the first note().
  std::int64_t host_ns(std::int64_t stamp_ns) const { return stamp_ns + *offset_ns_; }

 private:
  static constexpr std::int64_t kJumpNs = 500'000'000;
  static constexpr std::int64_t kStepNs = 1'000'000;
  /// No image comes before it was made: a clock that runs fast is followed, by 1000 ppm at 30 Hz at most.
  static constexpr std::int64_t kSlideNs = 33'000;

  std::optional<std::int64_t> offset_ns_;
  std::int64_t newest_ns_ = 0, newest_host_ns_ = std::numeric_limits<std::int64_t>::min() / 2;
};

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
