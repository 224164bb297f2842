// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"

namespace rtd::bus {

inline constexpr std::uint32_t kPortsOfDomain = 250;

/// UDP port on which the participants of a domain receive announcements (RTPS 2.2, 9.6.1.1). They share it.
constexpr std::uint16_t discovery_port(std::uint32_t domain) {
  return static_cast<std::uint16_t>(7400 + kPortsOfDomain * domain);
}

/// Throws BusError when another program has the domain's discovery port and does not share it: Fast DDS would start
/// and find no participant, without a message.
void require_discovery_port(std::uint32_t domain);

/// UDP port of the domain's participant with this id: what others write to it to find it.
constexpr std::uint16_t participant_port(std::uint32_t domain, int id) {
  return static_cast<std::uint16_t>(discovery_port(domain) + 10 + 2 * id);
}

/// Whether a process with these options is only found at one of the ports that peers ask, those of the ids below
/// kPeerParticipants. Others take one while there is a free one.
bool takes_participant_port(const BusOptions& options);
/// How many of them are free; nothing is opened. `udp_table`: for tests.
int free_participant_ports(std::uint32_t domain, const std::string& udp_table = "/proc/self/net/udp");
/// DDS domains in which a program on this host receives announcements, in order.
std::vector<std::uint32_t> domains_in_use(const std::string& udp_table = "/proc/self/net/udp");
/// No participant is in the domain, for it could only be on this host, where its discovery port would show it. False
/// when others may be on a network, or be found without that port. Ask before this process joins the domain.
bool surely_empty(const BusOptions& options, const std::string& udp_table = "/proc/self/net/udp");
/// For a process without peers in its domain: ", but on this host DDS runs in domain 0: ..."; empty when it does not.
std::string other_domains_hint(std::uint32_t domain, const std::string& udp_table = "/proc/self/net/udp");
/// Throws BusError when no such port is free.
void require_participant_port(std::uint32_t domain);

}  // namespace rtd::bus
