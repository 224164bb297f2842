// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/msg/status.hpp"

namespace rtd::service {

/// The metric of that name in a heartbeat; empty when it has none.
std::optional<double> find_metric(const msg::ServiceStatus& status, const std::string& name);

/// How far the clock of another host is ahead of this one's, and how long a message takes there and back.
struct ClockOffset {
  double offset_ms = 0;
  double round_trip_ms = 0;
};

/// Where the clocks of other hosts stand, as metrics of the heartbeat: `host_id` (the same for all processes of a
/// host), and for each service of another host `clock.SERVICE.received_ms` (its half of the comparison),
/// `clock.SERVICE.offset_ms` (how far its clock is ahead of ours) and `clock.SERVICE.round_trip_ms`.
///
/// Clocks are compared by the stamps of heartbeats both ways, as NTP does. We measure of a peer the least of
/// (arrival by our clock - its stamp) = delay - offset; the peer measures delay + offset of us and publishes it. Half
/// their difference is the offset, wrong by at most half the difference of the two delays; their sum is the round trip.
/// The least of the last half to one minute counts: it met no queue. Stamps are only compared, never changed. Reads no
/// clock; not thread-safe.
class PeerClocks {
 public:
  PeerClocks(std::string own_service, double own_host_id);

  /// A number for each host: of bus::host_partition().
  static double this_host_id();

  /// The metrics to publish from now on, after a heartbeat of another service; none when it is of this host.
  std::vector<msg::Metric> received(const msg::ServiceStatus& status, std::int64_t arrival_ns);
  void forget(const std::string& service) { least_.erase(service); }

 private:
  struct Least {
    std::int64_t began_ns = 0;
    std::int64_t now_ns = std::numeric_limits<std::int64_t>::max(), before_ns = now_ns;
  };
  /// The least that is measured of a peer, with this message.
  double measured_ms(const msg::ServiceStatus& status, std::int64_t arrival_ns);
  void warn_once(const msg::ServiceStatus& status, double host_id, const ClockOffset& offset);

  const std::string own_service_;
  const double own_host_id_;
  std::map<std::string, Least> least_;  ///< by service
  std::set<double> warned_hosts_;
};

}  // namespace rtd::service
