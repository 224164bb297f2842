// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::cyclonedds {

/// Where a process is asked for: at one of the ports of kPeerParticipants, or only by multicast, at any port.
enum class DiscoveryPort { kOfPeers, kAny };

/// Cyclone's configuration of a domain, as XML. Throws BusError: an interface or peer that is none
/// (common/bus/network.hpp).
std::string domain_config(const BusOptions& options, const HostLimits& limits,
                          DiscoveryPort port = DiscoveryPort::kOfPeers);

/// Throws BusError when no iox-roudi answers on this host: without it iceoryx waits for 60 s and then ends the process.
/// `socket`: where it listens; for tests.
void require_roudi(const std::string& socket = "/tmp/roudi");

}  // namespace rtd::bus::cyclonedds
