// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "common/msg/status.hpp"
#include "common/service/clock_offsets.hpp"

namespace rtd::service {

/// Where the clocks of other hosts stand, told in metrics of the heartbeat: `host_id` (the same for all processes of a
/// host), and for each service of another host `clock.SERVICE.heard_ms` (its half of the comparison, see ClockOffsets),
/// `clock.SERVICE.offset_ms` (how far its clock is ahead of ours) and `clock.SERVICE.round_trip_ms`. Not thread-safe.
class PeerClocks {
 public:
  PeerClocks(std::string own_service, double own_host_id);
  /// A number for each host: of bus::host_partition().
  static double this_host_id();

  /// The metrics to publish from now on, after a heartbeat of another service; none when it is of this host.
  std::vector<msg::Metric> received(const msg::ServiceStatus& status, std::int64_t arrival_ns);

 private:
  void warn_once(const msg::ServiceStatus& status, double host_id, const ClockOffset& offset);

  const std::string own_service_;
  const double own_host_id_;
  ClockOffsets clocks_;
  std::set<double> warned_hosts_;
};

}  // namespace rtd::service
