// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_clocks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "common/bus/network.hpp"
#include "common/service/log.hpp"
#include "common/service/status_metrics.hpp"

namespace rtd::service {
namespace {

constexpr double kWorthTellingMs = 10;  // above, latencies across hosts and stamps of different hosts mislead

}  // namespace

PeerClocks::PeerClocks(std::string own_service, double own_host_id)
    : own_service_(std::move(own_service)), own_host_id_(own_host_id) {}

/// The last 8 of its 16 hexadecimal digits: a double holds them exactly.
double PeerClocks::this_host_id() {
  const std::string name = bus::host_partition();
  return static_cast<double>(std::strtoul(name.substr(name.size() - 8).c_str(), nullptr, 16));
}

std::vector<msg::Metric> PeerClocks::received(const msg::ServiceStatus& status, std::int64_t arrival_ns) {
  const std::optional<double> host_id = find_metric(status, "host_id");
  if (!host_id || *host_id == own_host_id_) return {};
  clocks_.heard(status.service, status.stamp_ns, arrival_ns);
  const std::string prefix = "clock." + status.service + ".";
  std::vector<msg::Metric> told = {{prefix + "heard_ms", *clocks_.heard_ms(status.service)}};
  const std::optional<double> peer_hears_ms = find_metric(status, "clock." + own_service_ + ".heard_ms");
  if (!peer_hears_ms) return told;
  const ClockOffset offset = *clocks_.offset(status.service, *peer_hears_ms);
  told.push_back({prefix + "offset_ms", offset.offset_ms});
  told.push_back({prefix + "round_trip_ms", offset.round_trip_ms});
  warn_once(status, *host_id, offset);
  return told;
}

void PeerClocks::warn_once(const msg::ServiceStatus& status, double host_id, const ClockOffset& offset) {
  if (std::abs(offset.offset_ms) < kWorthTellingMs + offset.round_trip_ms / 2) return;
  if (!warned_hosts_.insert(host_id).second) return;
  SPDLOG_WARN(
      "event=clocks_differ peer={} ahead_ms={:.1f} round_trip_ms={:.1f} effect=\"stamps stay as they are, boxes are "
      "paired by the stamp of their frame; do not compare times of both hosts\" fix=\"run chrony on both\"",
      status.service, offset.offset_ms, offset.round_trip_ms);
}

}  // namespace rtd::service
