// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>

namespace rtd::service {

/// How far the clock of another host is ahead of this one's, and how long a message takes there and back.
struct ClockOffset {
  double offset_ms = 0;
  double round_trip_ms = 0;
};

/// Compares clocks by the stamps of messages both ways, as NTP does. What is heard of a peer is the least of
/// (arrival by our clock - its stamp) = delay - offset; the peer finds delay + offset of us and says so. Half their
/// difference is the offset, wrong by at most half the difference of the two delays; their sum is the round trip. The
/// least of the last half to one minute counts: it met no queue. Stamps are only compared, never changed. Reads no
/// clock; not thread-safe.
class ClockOffsets {
 public:
  void heard(const std::string& peer, std::int64_t stamp_ns, std::int64_t arrival_ns);
  /// Delay - offset of the peer, for it to know; empty: never heard.
  std::optional<double> heard_ms(const std::string& peer) const;
  /// `peer_hears_ms`: its heard_ms of us.
  std::optional<ClockOffset> offset(const std::string& peer, double peer_hears_ms) const;

 private:
  struct Least {
    std::int64_t began_ns = 0;
    std::int64_t now_ns = std::numeric_limits<std::int64_t>::max(), before_ns = now_ns;
    std::int64_t value_ns() const { return std::min(now_ns, before_ns); }
  };
  std::map<std::string, Least> peers_;
};

}  // namespace rtd::service
