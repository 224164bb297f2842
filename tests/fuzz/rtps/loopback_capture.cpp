// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/rtps/loopback_capture.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <unordered_map>

namespace rtd::fuzz {
namespace {

constexpr std::uint32_t kPortBase = 7400, kPortsOfDomain = 250;

std::uint32_t word16(const std::vector<unsigned char>& packet, std::size_t at) {
  return 256U * packet[at] + packet[at + 1];
}

}  // namespace

LoopbackCapture::LoopbackCapture(std::uint32_t domain)
    : socket_(::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP))),
      first_port_(kPortBase + kPortsOfDomain * domain) {
  if (socket_ < 0) return;
  sockaddr_ll loopback{};
  loopback.sll_family = AF_PACKET;
  loopback.sll_protocol = htons(ETH_P_IP);
  loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
  const int size = 8 << 20;
  setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback) == 0) return;
  ::close(socket_);
  socket_ = -1;
}

LoopbackCapture::~LoopbackCapture() {
  if (socket_ >= 0) ::close(socket_);
}

std::vector<Bytes> LoopbackCapture::listen(std::chrono::milliseconds duration, std::size_t count) {
  std::unordered_map<std::string, Bytes> different;
  std::vector<unsigned char> packet(70000);
  const auto until = std::chrono::steady_clock::now() + duration;
  while (std::chrono::steady_clock::now() < until && different.size() < count) {
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, 50) <= 0) continue;
    sockaddr_ll from{};
    socklen_t from_size = sizeof from;
    const ssize_t size =
        ::recvfrom(socket_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 28 || from.sll_pkttype == PACKET_OUTGOING) continue;
    const std::size_t ip = 4U * (packet[0] & 15U), payload = ip + 8;
    const bool udp = packet[9] == IPPROTO_UDP, fragment = (word16(packet, 6) & 0x3fffU) != 0;
    if (!udp || fragment || static_cast<std::size_t>(size) < payload + 20) continue;
    const std::uint32_t port = word16(packet, ip + 2);
    const bool ours = port >= first_port_ && port < first_port_ + kPortsOfDomain;
    if (!ours || std::memcmp(&packet[payload], "RTPS", 4) != 0) continue;
    const auto* const begin = reinterpret_cast<const std::byte*>(&packet[payload]);
    const auto* const end = begin + (static_cast<std::size_t>(size) - payload);
    different.try_emplace(std::string(reinterpret_cast<const char*>(begin), end - begin), begin, end);
  }
  std::vector<Bytes> datagrams;
  for (auto& [text, bytes] : different) datagrams.push_back(std::move(bytes));
  return datagrams;
}

}  // namespace rtd::fuzz
