// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace rtd::replay {

/// How far the time between two messages in a row was from the time that it should have been. Percentiles are exact to
/// 10 us up to 1 s.
class TimingError {
 public:
  void add(std::int64_t due_ns, std::int64_t sent_ns);
  /// The next message follows on a pause or a jump: the time before it means nothing.
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
