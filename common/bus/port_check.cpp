// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/port_check.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <set>

#include "common/bus/backend.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus {
namespace {

/// As DDS binds it: shared with others that share it too.
bool taken(std::uint16_t port) {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return false;
  const int yes = 1;
  setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const bool refused =
      bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 && errno == EADDRINUSE;
  close(probe);
  return refused;
}

/// A line: "  sl: ADDRESS:PORT ...", in hexadecimal, below a heading. `of_all`: only those that receive at any
/// address or at the group of DDS, 239.255.0.1.
std::set<int> ports_in_use(const std::string& udp_table, bool of_all) {
  std::set<int> ports;
  std::ifstream table(udp_table);
  std::string line, slot, address;
  std::getline(table, line);
  while (table >> slot >> address && std::getline(table, line)) {
    const std::size_t colon = address.find(':');
    if (colon == std::string::npos ||
        (of_all && !address.starts_with("00000000:") && !address.starts_with("0100FFEF:")))
      continue;
    ports.insert(static_cast<int>(std::strtol(&address[colon + 1], nullptr, 16)));
  }
  return ports;
}

}  // namespace

void require_discovery_port(std::uint32_t domain) {
  const std::uint16_t port = discovery_port(domain);
  if (!taken(port)) return;
  const std::string number = std::to_string(port);
  throw BusError("UDP port " + number + ", on which DDS domain " + std::to_string(domain) +
                 " finds its members, is in use by a program that does not share it: see who with 'ss -ulpn sport = :" +
                 number + "' and end it, or choose another domain (--domain, ROS_DOMAIN_ID)");
}

std::vector<std::uint32_t> domains_in_use(const std::string& udp_table) {
  constexpr std::uint32_t kDomains = 233;
  const std::set<int> ports = ports_in_use(udp_table, true);
  std::vector<std::uint32_t> domains;
  for (std::uint32_t domain = 0; domain < kDomains; ++domain)
    if (ports.contains(discovery_port(domain))) domains.push_back(domain);
  return domains;
}

bool surely_empty(const BusOptions& options, const std::string& udp_table) {
  const NetworkOptions& network = options.network;
  if (!network.loopback_only || !network.multicast || !network.peers.empty() || !network.discovery_server.empty())
    return false;
  const std::vector<std::uint32_t> in_use = domains_in_use(udp_table);
  return std::ifstream(udp_table).good() && std::ranges::count(in_use, static_cast<std::uint32_t>(options.domain)) == 0;
}

std::string other_domains_hint(std::uint32_t domain, const std::string& udp_table) {
  std::string others;
  for (const std::uint32_t other : domains_in_use(udp_table))
    if (other != domain) others += (others.empty() ? "" : ", ") + std::to_string(other);
  if (others.empty()) return {};
  return ", but on this host DDS runs in domain " + others + ": give all the same with --domain or ROS_DOMAIN_ID";
}

bool takes_participant_port(const BusOptions& options) {
  const NetworkOptions& network = options.network;
  if (!network.discovery_server.empty()) return false;
  const bool cyclone_peers = options.vendor == "cyclonedds" && !network.peers.empty();
  return !network.loopback_only || !network.multicast || cyclone_peers;
}

int free_participant_ports(std::uint32_t domain, const std::string& udp_table) {
  const std::set<int> in_use = ports_in_use(udp_table, false);
  int free = 0;
  for (int id = 0; id < kPeerParticipants; ++id) free += in_use.contains(participant_port(domain, id)) ? 0 : 1;
  return free;
}

void require_participant_port(std::uint32_t domain) {
  if (free_participant_ports(domain) > 0) return;
  throw BusError("all " + std::to_string(kPeerParticipants) + " UDP ports from " +
                 std::to_string(participant_port(domain, 0)) + " to " +
                 std::to_string(participant_port(domain, kPeerParticipants - 1)) +
                 ", at which peers look for DDS domain " + std::to_string(domain) +
                 ", are in use: see by whom with 'ss -ulpn' and end one, or choose another domain (--domain, "
                 "ROS_DOMAIN_ID)");
}

}  // namespace rtd::bus
