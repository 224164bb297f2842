// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/domain_config.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <memory>

#include "common/bus/backend.hpp"

namespace rtd::bus::cyclonedds {
namespace {

constexpr std::size_t kMostInterfaces = 4;  // of Cyclone DDS 0.10, loopback included
constexpr std::uint32_t kLeastDatagram = 576, kLargestDatagram = 65000;
/// RTPS and submessage headers, and with security its prefix, tag and postfix.
constexpr std::uint32_t kOverhead = 100, kSecureOverhead = 300;

/// Throws BusError unless the text can stand in an XML attribute as host, address or interface.
const std::string& checked(const std::string& text, const char* what) {
  const bool good = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == ':' || c == '-' || c == '_' || c == '%' || c == '@';
  });
  if (!good) throw BusError(std::string(what) + " '" + text + "' is none: use a host name, an IPv4 address or a name");
  return text;
}

bool is_address(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

std::string bytes(std::uint64_t number) {
  return std::to_string(number) + " B";
}

/// Loopback has no multicast flag in Linux, but carries it; so does Fast DDS on 127.0.0.1.
std::string interfaces(const NetworkOptions& network) {
  const std::string multicast = network.multicast ? "true" : "false";
  std::string all = R"(<NetworkInterface address="127.0.0.1" multicast=")" + multicast + R"("/>)";
  if (network.loopback_only) return element("Interfaces", all);
  const std::vector<std::string> names = network.interfaces.empty() ? network_interfaces() : network.interfaces;
  if (names.size() >= kMostInterfaces) {
    throw BusError("Cyclone DDS uses at most " + std::to_string(kMostInterfaces - 1) + " network interfaces, " +
                   std::to_string(names.size()) + " are named (bus.network.interfaces)");
  }
  for (const std::string& name : names) {
    all += "<NetworkInterface " + std::string(is_address(name) ? "address" : "name") + "=\"" +
           checked(name, "network interface") + R"(" multicast=")" + (network.multicast ? "default" : "false") +
           R"("/>)";
  }
  return element("Interfaces", all);
}

std::string general(const BusOptions& options) {
  const std::uint32_t datagram = std::clamp(options.network.max_datagram_bytes, kLeastDatagram, kLargestDatagram);
  const std::uint32_t overhead = options.security.enabled() ? kSecureOverhead : kOverhead;
  // Only discovery by multicast: data sent so would reach, and wake, every process of the domain.
  return element("General",
                 interfaces(options.network) + element("AllowMulticast", options.network.multicast ? "spdp" : "false") +
                     (options.network.loopback_only || !options.network.multicast
                          ? std::string()
                          : element("MulticastRecvNetworkInterfaceAddresses", "all")) +
                     element("MaxMessageSize", bytes(datagram)) + element("FragmentSize", bytes(datagram - overhead)));
}

/// Peers are asked at the ports of the participant numbers 0 to 60, and we take one of these: Fast DDS's as well.
std::string discovery(const NetworkOptions& network) {
  std::string text = element("SPDPInterval", "500 ms") + element("LeaseDuration", "5 s");
  if (network.multicast && network.peers.empty()) return element("Discovery", text);
  std::string peers = R"(<Peer address="127.0.0.1"/>)";
  for (const std::string& peer : network.peers) peers += "<Peer address=\"" + checked(peer, "peer") + "\"/>";
  text += element("Peers", peers) + element("ParticipantIndex", "auto") + element("MaxAutoParticipantIndex", "60");
  return element("Discovery", text);
}

/// A lost sample is noticed and repaired within some ms. No writer waits for a slow or dead reader: histories are
/// short, so the limit on bytes not yet acknowledged may be out of reach.
std::string internal(const BusOptions& options, const HostLimits& limits) {
  const auto buffer = [](const char* name, std::uint32_t size) {
    return "<" + std::string(name) + R"( min="default" max=")" + bytes(size) + "\"/>";
  };
  return element("Internal",
                 buffer("SocketReceiveBufferSize", socket_buffer_bytes(options.socket_buffer_kib, limits.rmem_max)) +
                     buffer("SocketSendBufferSize", socket_buffer_bytes(options.socket_buffer_kib, limits.wmem_max)) +
                     R"(<HeartbeatInterval min="5 ms" minsched="20 ms" max="1 s">20 ms</HeartbeatInterval>)" +
                     element("NackDelay", "5 ms") + element("AutoReschedNackDelay", "200 ms") +
                     element("Watermarks", element("WhcHigh", "1 GB") + element("WhcHighInit", "1 GB") +
                                               element("WhcAdaptive", "false")));
}

}  // namespace

std::vector<std::string> network_interfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> all(first, freeifaddrs);
  std::vector<std::string> names;
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    const bool up = (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
    if (!up || one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if (std::find(names.begin(), names.end(), one->ifa_name) == names.end()) names.emplace_back(one->ifa_name);
  }
  names.resize(std::min(names.size(), kMostInterfaces - 1));
  return names;
}

std::string domain_config(const BusOptions& options, const HostLimits& limits) {
  std::string text = general(options) + discovery(options.network) + internal(options, limits);
  if (options.iceoryx) text += element("SharedMemory", element("Enable", "true") + element("LogLevel", "warn"));
  return R"(<CycloneDDS><Domain Id="any">)" + text + "</Domain></CycloneDDS>";
}

}  // namespace rtd::bus::cyclonedds
