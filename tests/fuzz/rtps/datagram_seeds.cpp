// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/rtps/datagram_seeds.hpp"

#include <cstring>
#include <string>
#include <unordered_map>

namespace rtd::fuzz {

std::vector<Bytes> datagram_seeds(test_support::LoopbackCapture& capture, std::uint32_t domain,
                                  std::chrono::milliseconds duration, std::size_t count) {
  constexpr std::uint32_t kPortBase = 7400, kPortsOfDomain = 250;
  constexpr std::size_t kHeader = 20;
  const std::uint32_t first_port = kPortBase + kPortsOfDomain * domain;
  constexpr int kAlike = 40;  // else nearly all were fragments of images
  std::unordered_map<std::string, Bytes> different;
  std::unordered_map<std::string, int> of_kind;
  const auto until = std::chrono::steady_clock::now() + duration;
  while (std::chrono::steady_clock::now() < until && different.size() < count) {
    auto packet = capture.next(std::chrono::milliseconds(50));
    if (!packet || packet->fragment || packet->payload.size() < kHeader) continue;
    const bool ours = packet->port >= first_port && packet->port < first_port + kPortsOfDomain;
    const auto* const begin = reinterpret_cast<const char*>(packet->payload.data());
    if (!ours || std::memcmp(begin, "RTPS", 4) != 0) continue;
    if (++of_kind[kind_of(packet->payload)] > kAlike) continue;
    different.try_emplace(std::string(begin, packet->payload.size()), std::move(packet->payload));
  }
  std::vector<Bytes> datagrams;
  for (auto& [text, bytes] : different) datagrams.push_back(std::move(bytes));
  return datagrams;
}

}  // namespace rtd::fuzz
