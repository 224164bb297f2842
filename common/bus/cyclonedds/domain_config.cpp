// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/domain_config.hpp"

#include <algorithm>

#include "common/bus/backend.hpp"
#include "common/bus/network.hpp"
#include "common/msg/largest_sample.hpp"

namespace rtd::bus::cyclonedds {
namespace {

constexpr std::size_t kMaxInterfaces = 4;  // of Cyclone DDS 0.10, loopback included
constexpr std::uint32_t kLeastDatagram = 512, kLargestDatagram = 65000;
/// RTPS and submessage headers, a heartbeat that rides along, and with security its prefix, tag and postfix.
constexpr std::uint32_t kOverhead = 160, kSecureOverhead = 360;

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

std::string bytes(std::uint64_t number) {
  return std::to_string(number) + " B";
}

std::string interface(const std::string& address, const std::string& multicast, bool preferred) {
  return "<NetworkInterface address=\"" + address + "\" multicast=\"" + multicast + "\"" +
         (preferred ? " priority=\"10\"" : "") + "/>";
}

/// Loopback has no multicast flag in Linux, but carries it; so does Fast DDS on 127.0.0.1. Peers are asked through the
/// interface of the highest priority, whatever their address: by default that is loopback, from where no other host
/// is reached. Of two addresses of a process of this host Cyclone DDS takes that of loopback, so that ours go on when
/// the network is gone.
std::string interfaces(const NetworkOptions& network, const std::vector<std::string>& local_addresses) {
  std::vector<std::string> addresses = network.loopback_only ? local_addresses : interface_addresses(network);
  if (addresses.size() >= kMaxInterfaces && !network.interfaces.empty()) {
    throw BusError("--interface: Cyclone DDS uses at most " + std::to_string(kMaxInterfaces - 1) + ", " +
                   std::to_string(addresses.size()) + " are named");
  }
  addresses.resize(std::min(addresses.size(), kMaxInterfaces - 1));
  std::string all = interface("127.0.0.1", network.multicast ? "true" : "false", network.loopback_only);
  for (const std::string& address : addresses)
    all += interface(address, network.multicast ? "default" : "false", !network.loopback_only);
  return element("Interfaces", all);
}

/// A time to live of 0 keeps multicast on this host. Others join its groups on the interfaces of the network, where
/// ours need not.
std::string multicast(const NetworkOptions& network, bool stays_on_host) {
  if (!network.multicast) return element("AllowMulticast", "false");
  // Only discovery by multicast: data sent so would reach, and wake, every process of the domain.
  const std::string discovery_only = element("AllowMulticast", "spdp"),
                    receive = "MulticastRecvNetworkInterfaceAddresses";
  if (stays_on_host) return discovery_only + element("MulticastTimeToLive", "0") + element(receive, "127.0.0.1");
  return discovery_only + (network.loopback_only ? std::string() : element(receive, "all"));
}

std::string general(const BusOptions& options, const std::vector<std::string>& local_addresses) {
  const std::uint32_t datagram = std::clamp(options.network.max_datagram_bytes, kLeastDatagram, kLargestDatagram);
  const std::uint32_t overhead = options.security.enabled() ? kSecureOverhead : kOverhead;
  return element("General",
                 interfaces(options.network, local_addresses) + multicast(options.network, !local_addresses.empty()) +
                     element("MaxMessageSize", bytes(datagram)) + element("FragmentSize", bytes(datagram - overhead)));
}

/// As our Fast DDS does: each process takes one of the ports that peers without a port are asked at, and asks at
/// those of loopback.
std::string discovery(const NetworkOptions& network, DiscoveryPort port) {
  std::string text = element("SPDPInterval", "500 ms") + element("LeaseDuration", "5 s");
  std::string peers = R"(<Peer address="127.0.0.1"/>)";
  for (const std::string& peer : network.peers) {
    const HostAddress host = resolve_host(peer, "--peers");
    peers += "<Peer address=\"" + host.address + (host.port == 0 ? "" : ":" + std::to_string(host.port)) + "\"/>";
  }
  text += element("ParticipantIndex", port == DiscoveryPort::kOfPeers ? "auto" : "none") +
          element("MaxAutoParticipantIndex", std::to_string(kPeerParticipants - 1));
  return element("Discovery", text + element("Peers", peers));
}

/// A volatile reader begins with the first heartbeat of a writer of another vendor, for which it asks at once. A lost
/// sample is noticed and repaired within some ms. No writer waits for a slow or dead reader: histories are short, so
/// the limit on bytes not yet acknowledged may be out of reach. What is larger than any sample may be is given up when
/// its first fragment comes, as if the writer had said that it is gone.
std::string internal(const BusOptions& options, const HostLimits& limits) {
  const auto buffer = [](const char* name, std::uint32_t size) {
    return "<" + std::string(name) + R"( min="default" max=")" + bytes(size) + "\"/>";
  };
  return element(
      "Internal",
      buffer("SocketReceiveBufferSize", socket_buffer_bytes(options.socket_buffer_kib, limits.rmem_max)) +
          buffer("SocketSendBufferSize", socket_buffer_bytes(options.socket_buffer_kib, limits.wmem_max)) +
          R"(<HeartbeatInterval min="5 ms" minsched="20 ms" max="1 s">20 ms</HeartbeatInterval>)" +
          element("PreEmptiveAckDelay", "1 ms") + element("NackDelay", "5 ms") +
          element("AutoReschedNackDelay", "200 ms") + element("MaxSampleSize", bytes(msg::kLargestOfOthers)) +
          element("Watermarks",
                  element("WhcHigh", "1 GB") + element("WhcHighInit", "1 GB") + element("WhcAdaptive", "false")));
}

}  // namespace

std::string domain_config(const BusOptions& options, const HostLimits& limits, DiscoveryPort port,
                          const std::vector<std::string>& local_addresses) {
  std::string text = general(options, local_addresses) + discovery(options.network, port) + internal(options, limits);
  // The trace of discovery goes to UnmatchedWatch; the file is only to be one that can be opened.
  if (options.security.enabled())
    text += element("Tracing", element("Category", "discovery") + element("OutputFile", "/dev/null"));
  return R"(<CycloneDDS><Domain Id="any">)" + text + "</Domain></CycloneDDS>";
}

}  // namespace rtd::bus::cyclonedds
