// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_clocks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <utility>

#include "common/bus/network.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"

namespace rtd::service {
namespace {

constexpr std::int64_t kWindowNs = 30'000'000'000;  // clocks drift apart by 1 ms in it at the very most
constexpr double kNsPerMs = 1e6;
constexpr double kNotableMs = 10;  // above, latencies across hosts and stamps of different hosts mislead

}  // namespace

std::optional<double> find_metric(const msg::ServiceStatus& status, const std::string& name) {
  const auto found = std::ranges::find(status.metrics, name, &msg::Metric::name);
  return found == status.metrics.end() ? std::nullopt : std::optional(found->value);
}

PeerClocks::PeerClocks(std::string own_service, double own_host_id)
    : own_service_(std::move(own_service)), own_host_id_(own_host_id) {}

/// The last 8 of its 16 hexadecimal digits: a double holds them exactly.
double PeerClocks::this_host_id() {
  static const double id = [] {  // asked for every heartbeat
    const std::string name = bus::host_partition();
    return static_cast<double>(std::strtoul(name.substr(name.size() - 8).c_str(), nullptr, 16));
  }();
  return id;
}

double PeerClocks::measured_ms(const msg::ServiceStatus& status, std::int64_t arrival_ns) {
  constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  Least& least = least_[status.service];
  const std::int64_t age_ns = arrival_ns - least.began_ns;
  if (age_ns > kWindowNs || age_ns < 0) {  // negative: our clock was set back
    least = {arrival_ns, kNone, age_ns > 0 && age_ns < 2 * kWindowNs ? least.now_ns : kNone};
  }
  least.now_ns = std::min(least.now_ns, arrival_ns - status.stamp_ns);
  return static_cast<double>(std::min(least.now_ns, least.before_ns)) / kNsPerMs;
}

std::vector<msg::Metric> PeerClocks::received(const msg::ServiceStatus& status, std::int64_t arrival_ns) {
  const std::optional<double> host_id = find_metric(status, metric::kHostId);
  if (!host_id || *host_id == own_host_id_) return {};
  const double own_ms = measured_ms(status, arrival_ns);
  const std::string prefix = metric::kClockPrefix + status.service;
  std::vector<msg::Metric> metrics = {{prefix + metric::kClockReceivedSuffix, own_ms}};
  const std::optional<double> peer_ms =
      find_metric(status, metric::kClockPrefix + own_service_ + metric::kClockReceivedSuffix);
  if (!peer_ms) return metrics;
  const ClockOffset offset{(*peer_ms - own_ms) / 2, *peer_ms + own_ms};
  metrics.push_back({prefix + metric::kClockOffsetSuffix, offset.offset_ms});
  metrics.push_back({prefix + metric::kClockRoundTripSuffix, offset.round_trip_ms});
  warn_once(status, *host_id, offset);
  return metrics;
}

void PeerClocks::warn_once(const msg::ServiceStatus& status, double host_id, const ClockOffset& offset) {
  if (std::abs(offset.offset_ms) < kNotableMs + offset.round_trip_ms / 2) return;
  constexpr std::size_t kMaxWarnings = 100;  // host ids may be made up
  if (warned_hosts_.size() >= kMaxWarnings || !warned_hosts_.insert(host_id).second) return;
  SPDLOG_WARN(
      "event=clocks_differ peer={} ahead_ms={:.1f} round_trip_ms={:.1f} effect=\"stamps stay as they are, boxes are "
      "paired by the stamp of their frame; do not compare times of both hosts\" fix=\"run chrony on both\"",
      status.service, offset.offset_ms, offset.round_trip_ms);
}

}  // namespace rtd::service
