// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/network.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "common/bus/backend.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/bus/robot.hpp"
#include "common/io/printable.hpp"

namespace rtd::bus {
namespace {

struct Interface {
  std::string name, address;
};

std::string to_text(const sockaddr* address) {
  char text[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof(text));
  return text;
}

/// Up, with an IPv4 address, not loopback.
std::vector<Interface> network_interfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(first, freeifaddrs);
  std::vector<Interface> found;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    if ((entry->ifa_flags & IFF_UP) == 0 || (entry->ifa_flags & IFF_LOOPBACK) != 0) continue;
    found.push_back({entry->ifa_name, to_text(entry->ifa_addr)});
  }
  return found;
}

bool is_bridge(const std::string& interface) {
  std::error_code error;
  return std::filesystem::is_directory("/sys/class/net/" + interface + "/bridge", error);
}

std::string listed(const std::vector<Interface>& interfaces) {
  std::string text;
  for (const auto& [name, address] : interfaces) text += (text.empty() ? "" : ", ") + name + " (" + address + ")";
  return text.empty() ? "none" : text;
}

std::uint16_t parse_port(const std::string& digits, const std::string& text, const std::string& option) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error == std::errc() && end == digits.data() + digits.size() && port > 0) return port;
  throw BusError(option + " " + text + ": '" + io::abridged(digits) +
                 "' is not a port, write HOST or HOST:PORT with 1..65535");
}

}  // namespace

HostAddress resolve_host(const std::string& text, const std::string& option) {
  const std::size_t colon = text.find(':');
  HostAddress host;
  if (colon != std::string::npos) host.port = parse_port(text.substr(colon + 1), text, option);
  const std::string name = text.substr(0, colon);
  addrinfo hints{}, *first = nullptr;
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  const int error = name.empty() ? EAI_NONAME : getaddrinfo(name.c_str(), nullptr, &hints, &first);
  if (error != 0)
    throw BusError(option + " " + text + ": no IPv4 address for '" + io::abridged(name) + "' (" + gai_strerror(error) +
                   "); write its address, or add the name to /etc/hosts");
  host.address = to_text(first->ai_addr);
  freeaddrinfo(first);
  return host;
}

std::vector<std::string> host_addresses() {
  std::vector<std::string> addresses;
  for (const auto& [name, address] : network_interfaces())
    if (!is_bridge(name)) addresses.push_back(address);
  return addresses;
}

std::vector<std::string> interface_addresses(const NetworkOptions& network) {
  if (network.loopback_only) return {};
  const std::vector<Interface> present = network_interfaces();
  std::vector<std::string> addresses;
  for (const std::string& asked : network.interfaces) {
    const std::size_t before = addresses.size();
    for (const auto& [name, address] : present)
      if (name == asked || address == asked) addresses.push_back(address);
    if (addresses.size() == before)
      throw BusError("--interface " + asked + ": not up or without an IPv4 address; there are " + listed(present));
  }
  if (!network.interfaces.empty()) return addresses;
  addresses = host_addresses();
  if (addresses.empty())
    throw BusError("no network interface is up: connect this host, name a bridge with --interface (there are: " +
                   listed(present) + "), or use --profile localhost");
  return addresses;
}

bool is_own_address(const std::string& address) {
  return std::ranges::any_of(network_interfaces(), [&](const Interface& one) { return one.address == address; });
}

bool stays_on_host(std::string_view topic) {
  const std::string name = split_robot(topic).topic;
  const auto frames = frame_topics();
  return name == topics::kFeatures.name ||
         std::ranges::any_of(frames, [&](const FrameTopic& frame) { return name == frame.name; });
}

/// From the kernel's start and the device of /dev/shm: containers share memory or not, whatever their network.
std::string host_partition() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  struct stat shared {};
  if (stat("/dev/shm", &shared) == 0) boot += ":" + std::to_string(shared.st_dev);
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a, the same in every build
  for (const char letter : boot) hash = (hash ^ static_cast<std::uint8_t>(letter)) * 0x100000001b3;
  char text[32];
  std::snprintf(text, sizeof(text), "host-%016llx", static_cast<unsigned long long>(hash));
  return text;
}

void require_network(const BusOptions& options) {
  const NetworkOptions& network = options.network;
  for (const std::string& peer : network.peers) {
    if (network.loopback_only && !resolve_host(peer, "--peers").address.starts_with("127."))
      throw BusError("--peers " + peer + " is another host, but only loopback is used: add --profile lan or wifi");
  }
  if (network.discovery_server.empty()) return;
  if (options.vendor == "cyclonedds")
    throw BusError("--discovery-server " + network.discovery_server +
                   ": Cyclone DDS cannot use one; name hosts with --peers, or use --dds fastdds");
  if (resolve_host(network.discovery_server, "--discovery-server").port == 0)
    throw BusError("--discovery-server " + network.discovery_server +
                   ": without a port, write HOST:PORT (fast-discovery-server takes 11811)");
}

std::string no_server_problem(const BusOptions& options) {
  const std::string& server = options.network.discovery_server;
  const std::size_t colon = server.find(':');
  const std::string host = server.substr(0, colon), port = colon == std::string::npos ? "" : server.substr(colon + 1);
  return "no Discovery Server answers at " + server + ", without which no participant is found: start it there with " +
         "'fast-discovery-server -i 0 -l " + host + " -p " + port + "' (id 0), let UDP port " + port +
         " through the firewall, or correct --discovery-server";
}

}  // namespace rtd::bus
