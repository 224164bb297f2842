// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rtd::test_support {

/// Receives what goes over UDP on the loopback interface. Needs CAP_NET_RAW.
class LoopbackCapture {
 public:
  struct Packet {
    std::uint16_t port = 0;  ///< to which it goes
    bool fragment = false;   ///< a part of a datagram that IP has cut; the payload then is what this part holds
    std::vector<std::byte> payload;
  };

  LoopbackCapture();
  ~LoopbackCapture();
  LoopbackCapture(const LoopbackCapture&) = delete;
  LoopbackCapture& operator=(const LoopbackCapture&) = delete;

  bool permitted() const { return socket_ >= 0; }
  /// Empty when none came within the wait.
  std::optional<Packet> next(std::chrono::milliseconds wait);
  /// Packets that came faster than they were taken, since the last call.
  unsigned lost();

 private:
  int socket_;
};

}  // namespace rtd::test_support
