// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/loopback_capture.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace rtd::test_support {
namespace {

constexpr std::size_t kUdpHeader = 8;

unsigned word16(const std::vector<std::byte>& packet, std::size_t at) {
  return 256U * std::to_integer<unsigned>(packet[at]) + std::to_integer<unsigned>(packet[at + 1]);
}

/// Of an IPv4 packet; empty when it is none of UDP.
std::optional<LoopbackCapture::Packet> udp_in(const std::vector<std::byte>& ip) {
  constexpr std::byte kUdp{IPPROTO_UDP};
  if (ip.size() < 20 || ip[9] != kUdp) return std::nullopt;
  const std::size_t header = 4U * (std::to_integer<unsigned>(ip[0]) & 15U);
  const unsigned flags_and_offset = word16(ip, 6);
  LoopbackCapture::Packet packet;
  packet.fragment = (flags_and_offset & 0x3fffU) != 0;
  std::size_t begin = header;
  if ((flags_and_offset & 0x1fffU) == 0) {  // the first or only part
    begin += kUdpHeader;
    if (ip.size() < begin) return std::nullopt;
    packet.port = static_cast<std::uint16_t>(word16(ip, header + 2));
  }
  packet.payload.assign(ip.begin() + static_cast<std::ptrdiff_t>(begin), ip.end());
  return packet;
}

}  // namespace

LoopbackCapture::LoopbackCapture() : socket_(::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP))) {
  if (socket_ < 0) return;
  sockaddr_ll loopback{};
  loopback.sll_family = AF_PACKET;
  loopback.sll_protocol = htons(ETH_P_IP);
  loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
  const int size = 8 << 20;
  if (setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size) != 0)
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback) == 0) return;
  ::close(socket_);
  socket_ = -1;
}

LoopbackCapture::~LoopbackCapture() {
  if (socket_ >= 0) ::close(socket_);
}

std::optional<LoopbackCapture::Packet> LoopbackCapture::next(std::chrono::milliseconds wait) {
  const auto until = std::chrono::steady_clock::now() + wait;
  std::vector<std::byte> bytes(70000);
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, left.count() > 0 ? static_cast<int>(left.count()) : 0) <= 0) return std::nullopt;
    sockaddr_ll from{};
    socklen_t from_size = sizeof from;
    bytes.resize(70000);
    const ssize_t size =
        ::recvfrom(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size <= 0 || from.sll_pkttype == PACKET_OUTGOING) continue;  // it comes in as well
    bytes.resize(static_cast<std::size_t>(size));
    if (auto packet = udp_in(bytes)) return packet;
  }
}

unsigned LoopbackCapture::lost() {
  tpacket_stats statistics{};
  socklen_t size = sizeof statistics;
  getsockopt(socket_, SOL_PACKET, PACKET_STATISTICS, &statistics, &size);
  return statistics.tp_drops;
}

}  // namespace rtd::test_support
