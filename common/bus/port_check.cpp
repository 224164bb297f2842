// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/port_check.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "common/bus/backend.hpp"

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

}  // namespace

void require_discovery_port(std::uint32_t domain) {
  const std::uint16_t port = discovery_port(domain);
  if (!taken(port)) return;
  const std::string number = std::to_string(port);
  throw BusError("UDP port " + number + ", on which DDS domain " + std::to_string(domain) +
                 " finds its members, is in use by a program that does not share it: see who with 'ss -ulpn sport = :" +
                 number + "' and end it, or choose another domain (--domain, ROS_DOMAIN_ID)");
}

}  // namespace rtd::bus
