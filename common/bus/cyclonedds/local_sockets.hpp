// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::bus::cyclonedds {

/// While it lives, each IPv4 datagram socket that this thread binds receives only what this host sends: what arrives
/// by the loopback interface, and the host's own multicast. The kernel drops the rest before any program reads it. So a
/// domain that is kept to this host can be at the addresses of the network, which others on this host answer at.
/// One at a time in a thread.
class LocalSockets {
 public:
  LocalSockets();
  ~LocalSockets();
  LocalSockets(const LocalSockets&) = delete;
  LocalSockets& operator=(const LocalSockets&) = delete;

  /// False with AddressSanitizer or ThreadSanitizer, which have a bind() themselves.
  static bool available();
  /// Sockets bound so far.
  int bound() const { return bound_; }
  /// Filters a socket that is about to be bound. False, with errno: the kernel refused.
  bool admit(int socket);

 private:
  int bound_ = 0;
};

}  // namespace rtd::bus::cyclonedds
