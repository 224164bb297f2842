// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus_factory.hpp"

/// What NetworkOptions mean on this host, the same for every vendor.
namespace rtd::bus {

/// Participants of a host that a peer without a port is asked for: those at the discovery ports of the first ids of a
/// domain, 7410 + 250 * domain + 2 * id. Each of our participants takes the first free one of them. ROS 2 with
/// ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST finds others by asking as many, on loopback.
inline constexpr int kPeerParticipants = 32;

/// Why a vendor may refuse to join a domain.
inline constexpr char kMayBeRefused[] =
    "is the loopback interface up (ip link set lo up), are fewer than 60 participants in this domain, and does no "
    "other program hold its ports (ss -ulpn)? Above domain 101 Linux lends them to any program";

/// An IPv4 address; port 0: the discovery ports of the domain's first kPeerParticipants participants.
struct HostAddress {
  std::string address;
  std::uint16_t port = 0;
  bool operator==(const HostAddress&) const = default;
};

/// HOST or HOST:PORT, names resolved. Throws BusError naming `option` when it cannot be.
HostAddress resolve_host(const std::string& text, const std::string& option);

/// IPv4 addresses of the interfaces to use besides loopback: those named, or all that are up but bridges (those of
/// containers and virtual machines). Empty with loopback_only. Throws BusError: no such interface, none is up.
std::vector<std::string> interface_addresses(const NetworkOptions& network);

/// IPv4 addresses of this host's interfaces that are up, but loopback and bridges. Empty when there are none.
std::vector<std::string> host_addresses();

/// Whether an interface of this host has this IPv4 address.
bool is_own_address(const std::string& address);

/// Topics of any robot that no other host gets: raw frames and features, 1.5 and 0.1 MB thirty times a second. Their
/// writers on a network are in the partition host_partition() only, our readers ask for it and for the default one.
bool stays_on_host(std::string_view topic);

/// The same text for all processes that share memory, another one elsewhere: "host-0123456789abcdef".
std::string host_partition();

/// All that can be checked without a vendor. Throws BusError: peers outside while only loopback is used, a peer that
/// cannot be resolved, a Discovery Server with a vendor other than Fast DDS.
void require_network(const BusOptions& options);

/// How long a Discovery Server may take until it is called missing. It answers within some ms; ours ask every 0.5 s.
inline constexpr std::chrono::milliseconds kServerPatience{3000};
/// The problem to report then.
std::string no_server_problem(const BusOptions& options);

}  // namespace rtd::bus
