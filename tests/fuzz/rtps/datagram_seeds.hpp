// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "tests/fuzz/rtps/rtps_datagram.hpp"
#include "tests/support/loopback_capture.hpp"

namespace rtd::fuzz {

/// Different RTPS datagrams to the ports of a DDS domain in the next while, at most `count` and few of a kind;
/// fragments of IP are left out.
std::vector<Bytes> datagram_seeds(test_support::LoopbackCapture& capture, std::uint32_t domain,
                                  std::chrono::milliseconds duration, std::size_t count);

}  // namespace rtd::fuzz
