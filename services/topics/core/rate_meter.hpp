// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rtd::topics {

/// The rate of a stream of messages. Times are of any monotonic clock.
struct Rate {
  std::uint64_t messages = 0, bytes = 0, lost = 0;
  double hz = 0;  ///< from the periods between messages; 0 for fewer than two messages
  double mean_ms = 0, deviation_ms = 0, shortest_ms = 0, longest_ms = 0;
};

/// Measures the periods between the messages of a topic, without keeping them.
class RateMeter {
 public:
  void add(std::int64_t received_ns, std::size_t bytes);
  void add_lost(std::uint64_t count) { lost_ += count; }
  std::uint64_t messages() const { return messages_; }
  Rate rate() const;

 private:
  std::uint64_t messages_ = 0, bytes_ = 0, lost_ = 0;
  std::int64_t last_ns_ = 0, shortest_ns_ = 0, longest_ns_ = 0;
  double mean_ns_ = 0, squares_ns2_ = 0;  ///< Welford's running mean and sum of squared deviations
};

}  // namespace rtd::topics
