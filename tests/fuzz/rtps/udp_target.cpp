// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/rtps/udp_target.hpp"

#include <arpa/inet.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>

namespace rtd::fuzz {
namespace {

namespace fs = std::filesystem;

struct UdpSocket {
  std::uint32_t port = 0;
  unsigned long queued_bytes = 0, inode = 0, drops = 0;
};

std::vector<UdpSocket> udp_sockets() {
  std::vector<UdpSocket> sockets;
  std::ifstream table("/proc/net/udp");
  for (std::string line; std::getline(table, line);) {
    UdpSocket socket;
    unsigned long sent = 0;
    if (std::sscanf(line.c_str(), " %*d: %*x:%x %*x:%*x %*x %lx:%lx %*x:%*x %*x %*u %*d %lu %*d %*x %lu", &socket.port,
                    &sent, &socket.queued_bytes, &socket.inode, &socket.drops) == 5)
      sockets.push_back(socket);
  }
  return sockets;
}

std::set<std::string> open_files(pid_t process) {
  std::set<std::string> files;
  std::error_code error;
  for (fs::directory_iterator file("/proc/" + std::to_string(process) + "/fd", error), end; !error && file != end;
       file.increment(error))
    files.insert(fs::read_symlink(file->path(), error).string());
  return files;
}

}  // namespace

UdpTarget::UdpTarget(pid_t process, std::uint32_t first, std::uint32_t last)
    : process_(process), socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  const std::set<std::string> files = open_files(process);
  for (const UdpSocket& socket : udp_sockets()) {
    const bool own = files.contains("socket:[" + std::to_string(socket.inode) + "]");
    if (own && socket.port >= first && socket.port <= last) ports_.push_back(static_cast<std::uint16_t>(socket.port));
  }
  drops_before_ = drops_of_ports();
}

UdpTarget::~UdpTarget() {
  ::close(socket_);
}

void UdpTarget::send(const Bytes& datagram, std::uint16_t port) const {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

bool UdpTarget::wait_until_read() const {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < give_up && ::kill(process_, 0) == 0) {
    unsigned long waiting = 0;
    for (const UdpSocket& socket : udp_sockets())
      if (std::find(ports_.begin(), ports_.end(), socket.port) != ports_.end()) waiting += socket.queued_bytes;
    if (waiting < 100'000) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

std::uint64_t UdpTarget::drops_of_ports() const {
  std::uint64_t drops = 0;
  for (const UdpSocket& socket : udp_sockets())
    if (std::find(ports_.begin(), ports_.end(), socket.port) != ports_.end()) drops += socket.drops;
  return drops;
}

std::uint64_t UdpTarget::dropped() const {
  const std::uint64_t drops = drops_of_ports();
  return drops > drops_before_ ? drops - drops_before_ : 0;  // of a dead process the ports are gone
}

}  // namespace rtd::fuzz
