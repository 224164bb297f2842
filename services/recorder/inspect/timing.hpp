// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/mcap/records.hpp"

namespace rtd::recording {

/// How regularly the messages of a channel came, by log_time.
struct Timing {
  std::uint64_t messages = 0;
  mcap::Timestamp first_ns = 0, last_ns = 0;
  double rate_hz = 0;  ///< 0 for fewer than two messages or no time between them
  std::uint64_t median_period_ns = 0;
  std::uint64_t largest_gap_ns = 0;
  mcap::Timestamp largest_gap_at_ns = 0;  ///< where it begins
  std::uint64_t gaps = 0;                 ///< periods longer than kGapPeriods medians
};

inline constexpr double kGapPeriods = 2.5;

/// Of times in any order.
Timing timing_of(std::vector<mcap::Timestamp> times_ns);

/// Counts what is missing in the sequence numbers of a channel. A smaller number than the one before is a writer that
/// began again, or another one.
class SequenceCount {
 public:
  void add(std::uint32_t sequence);
  /// Empty where numbers begin again: several writers, or one that was restarted, cannot be told apart.
  std::optional<std::uint64_t> missing() const { return restarts_ > 0 ? std::nullopt : std::optional(missing_); }
  std::uint64_t gaps() const { return gaps_; }
  std::uint64_t restarts() const { return restarts_; }
  /// False when all numbers are 0: the recorder had none.
  bool numbered() const { return numbered_; }

 private:
  bool any_ = false, numbered_ = false;
  std::uint32_t last_ = 0;
  std::uint64_t missing_ = 0, gaps_ = 0, restarts_ = 0;
};

}  // namespace rtd::recording
