// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rtd::replay {

/// Says when what was recorded at a time is due, on the clock of the one who asks. Every time follows from one anchor,
/// so no error adds up.
class Schedule {
 public:
  /// `rate` > 0: 2 is twice as fast as recorded.
  explicit Schedule(double rate) : rate_(rate) {}

  /// The playhead stands at `recorded_ns` now.
  void jump(std::int64_t recorded_ns, std::int64_t now_ns);
  void pause(std::int64_t now_ns);
  void resume(std::int64_t now_ns);
  void set_rate(double rate, std::int64_t now_ns);

  bool paused() const { return paused_; }
  double rate() const { return rate_; }
  /// When it is due; not to be asked while paused.
  std::int64_t due_ns(std::int64_t recorded_ns) const;
  /// Where the playhead is.
  std::int64_t recorded_ns(std::int64_t now_ns) const;

 private:
  double rate_;
  bool paused_ = false;
  std::int64_t anchor_recorded_ns_ = 0, anchor_ns_ = 0;
};

}  // namespace rtd::replay
