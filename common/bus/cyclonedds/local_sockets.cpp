// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/local_sockets.hpp"

#include <dlfcn.h>
#include <linux/filter.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>

namespace rtd::bus::cyclonedds {
namespace {

thread_local LocalSockets* current = nullptr;

bool is_ipv4_datagram_socket(int socket) {
  int domain = 0, type = 0;
  socklen_t size = sizeof(int);
  return getsockopt(socket, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 && domain == AF_INET &&
         getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
}

}  // namespace

LocalSockets::LocalSockets() {
  current = this;
}

LocalSockets::~LocalSockets() {
  current = nullptr;
}

bool LocalSockets::available() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;
#else
  return true;
#endif
}

/// What a host sends to any of its own addresses comes back by loopback; its multicast comes back on the interface that
/// it left by, marked.
bool LocalSockets::admit(int socket) {
  if (!is_ipv4_datagram_socket(socket)) return true;
  constexpr auto kInterface = static_cast<__u32>(SKF_AD_OFF + SKF_AD_IFINDEX);
  constexpr auto kPacketType = static_cast<__u32>(SKF_AD_OFF + SKF_AD_PKTTYPE);
  std::array<sock_filter, 6> rules = {{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kPacketType),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PACKET_LOOPBACK, 2, 0),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kInterface),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, if_nametoindex("lo"), 0, 1),
      BPF_STMT(BPF_RET | BPF_K, 0xffffffff),
      BPF_STMT(BPF_RET | BPF_K, 0),
  }};
  const sock_fprog program{static_cast<unsigned short>(rules.size()), rules.data()};
  if (setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)) != 0) return false;
  ++bound_;
  return true;
}

}  // namespace rtd::bus::cyclonedds

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
/// Stands before the function of the C library.
extern "C" int bind(int socket, const sockaddr* address, socklen_t size) noexcept {
  static const auto original = reinterpret_cast<int (*)(int, const sockaddr*, socklen_t)>(dlsym(RTLD_NEXT, "bind"));
  if (rtd::bus::cyclonedds::current != nullptr && !rtd::bus::cyclonedds::current->admit(socket)) return -1;
  return original(socket, address, size);
}
#endif
