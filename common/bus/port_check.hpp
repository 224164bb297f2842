// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rtd::bus {

/// UDP port on which the participants of a domain hear each other's announcements (RTPS 2.2, 9.6.1.1). They share it.
constexpr std::uint16_t discovery_port(std::uint32_t domain) {
  return static_cast<std::uint16_t>(7400 + 250 * domain);
}

/// Throws BusError when another program has the domain's discovery port and does not share it: Fast DDS would start
/// and hear nobody, without a word.
void require_discovery_port(std::uint32_t domain);

}  // namespace rtd::bus
