// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <vector>

#include "tests/fuzz/rtps/rtps_datagram.hpp"

namespace rtd::fuzz {

/// The UDP ports of a process, and a socket to send there over loopback no faster than it reads.
class UdpTarget {
 public:
  /// Ports from `first` to `last` that the process has bound.
  UdpTarget(pid_t process, std::uint32_t first, std::uint32_t last);
  ~UdpTarget();
  UdpTarget(const UdpTarget&) = delete;
  UdpTarget& operator=(const UdpTarget&) = delete;

  const std::vector<std::uint16_t>& ports() const { return ports_; }
  void send(const Bytes& datagram, std::uint16_t port) const;
  /// Waits until its sockets have been read empty, at most a while. False when they are not or the process is gone.
  bool wait_until_read() const;
  /// Datagrams that found no room in its sockets so far.
  std::uint64_t dropped() const;

 private:
  std::uint64_t drops_of_ports() const;

  const pid_t process_;
  std::uint64_t drops_before_ = 0;
  std::vector<std::uint16_t> ports_;
  int socket_;
};

}  // namespace rtd::fuzz
