// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/clock_offsets.hpp"

namespace rtd::service {
namespace {

constexpr std::int64_t kWindowNs = 30'000'000'000;  // clocks drift apart by 1 ms in it at the very most
constexpr double kNsPerMs = 1e6;

}  // namespace

void ClockOffsets::heard(const std::string& peer, std::int64_t stamp_ns, std::int64_t arrival_ns) {
  Least& least = peers_[peer];
  const std::int64_t age_ns = arrival_ns - least.began_ns;
  if (age_ns > kWindowNs || age_ns < 0) {  // negative: our clock was set back
    least.before_ns = age_ns > 0 && age_ns < 2 * kWindowNs ? least.now_ns : std::numeric_limits<std::int64_t>::max();
    least.now_ns = std::numeric_limits<std::int64_t>::max();
    least.began_ns = arrival_ns;
  }
  least.now_ns = std::min(least.now_ns, arrival_ns - stamp_ns);
}

std::optional<double> ClockOffsets::heard_ms(const std::string& peer) const {
  const auto found = peers_.find(peer);
  if (found == peers_.end()) return std::nullopt;
  return static_cast<double>(found->second.value_ns()) / kNsPerMs;
}

std::optional<ClockOffset> ClockOffsets::offset(const std::string& peer, double peer_hears_ms) const {
  const std::optional<double> we_hear_ms = heard_ms(peer);
  if (!we_hear_ms) return std::nullopt;
  return ClockOffset{(peer_hears_ms - *we_hear_ms) / 2, peer_hears_ms + *we_hear_ms};
}

}  // namespace rtd::service
