// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::cyclonedds {

/// Where a process is asked for: at one of the ports of kPeerParticipants, or only by multicast, at any port.
enum class DiscoveryPort { kOfPeers, kAny };

/// Cyclone's configuration of a domain, as XML. `local_addresses`: of this host, at which programs of this host are
/// answered in a domain that is kept to it; multicast does not leave the host then, and the caller sees to it that
/// nothing comes in (local_sockets.hpp). Throws BusError: an interface or peer that is none (common/bus/network.hpp).
std::string domain_config(const BusOptions& options, const HostLimits& limits,
                          DiscoveryPort port = DiscoveryPort::kOfPeers,
                          const std::vector<std::string>& local_addresses = {});

}  // namespace rtd::bus::cyclonedds
