// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/bus_factory.hpp"
#include "common/bus/fastdds/versions/vendor.hpp"
#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::fastdds {

/// How much a participant wants to know of others' endpoints from a Discovery Server.
enum class DiscoveryScope {
  kMatching,  ///< those of its own topics
  kAll,       ///< all of the domain: recorders, tools
};

/// Transports and discovery of NetworkOptions. Samples of a host go through shared memory in every profile, unless
/// `in_shared_memory` is false; UDP on loopback and the chosen interfaces is for discovery and for other hosts, cut to
/// max_datagram_bytes.
void map_network(const BusOptions& options, bool in_shared_memory, const HostLimits& limits, DiscoveryScope scope,
                 dds::DomainParticipantQos& qos);

/// Whose Discovery Server is asked: that of `fast-discovery-server -i 0`.
const ParticipantId& server_id();

}  // namespace rtd::bus::fastdds
