// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rtd::replay {

/// Maps recorded times to due times on the caller's clock. Every time is computed from one anchor, so errors do not
/// add up.
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
  /// When a recorded time is due; not for use while paused.
  std::int64_t due_ns(std::int64_t recorded_ns) const;
  /// Where the playhead is.
  std::int64_t recorded_ns(std::int64_t now_ns) const;

 private:
  double rate_;
  bool paused_ = false;
  std::int64_t anchor_recorded_ns_ = 0, anchor_ns_ = 0;
};

/// Measures by how much the time between consecutive messages differs from the recorded one. Percentiles are exact to
/// 10 us up to 1 s.
class TimingError {
 public:
  void add(std::int64_t due_ns, std::int64_t sent_ns);
  /// The next message follows a pause or a jump: the time before it does not count.
  void interrupt() { any_ = false; }

  std::uint64_t count() const { return count_; }
  double percentile_ms(double percent) const;  ///< 0 when nothing was measured
  double max_ms() const { return static_cast<double>(max_ns_) * 1e-6; }

 private:
  static constexpr std::int64_t kBinNs = 10'000;
  static constexpr std::size_t kBins = 100'000;
  std::vector<std::uint32_t> bins_ = std::vector<std::uint32_t>(kBins);
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0, last_due_ns_ = 0, last_sent_ns_ = 0;
  bool any_ = false;
};

}  // namespace rtd::replay
