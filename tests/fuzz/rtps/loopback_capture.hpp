// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "tests/fuzz/rtps/rtps_datagram.hpp"

namespace rtd::fuzz {

/// Hears the RTPS datagrams of a DDS domain on the loopback interface. Needs CAP_NET_RAW.
class LoopbackCapture {
 public:
  explicit LoopbackCapture(std::uint32_t domain);
  ~LoopbackCapture();
  LoopbackCapture(const LoopbackCapture&) = delete;
  LoopbackCapture& operator=(const LoopbackCapture&) = delete;

  bool permitted() const { return socket_ >= 0; }
  /// Different datagrams of the next while, at most `count`; fragments of IP are left out.
  std::vector<Bytes> listen(std::chrono::milliseconds duration, std::size_t count);

 private:
  int socket_;
  std::uint32_t first_port_;
};

}  // namespace rtd::fuzz
