// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace rtd::bus {

/// Identity of a writer in the domain (its GUID); readers have such ids too. A message cannot choose it: it is what the
/// connection that sent the message has, and in a secured domain it belongs to that connection's certificate.
using WriterId = std::array<std::uint8_t, 16>;
std::string to_string(const WriterId& id);  ///< hexadecimal, e.g. "010f5b2a..."

/// Identity of a connection in the domain: the first bytes of its endpoints' ids.
using ParticipantId = std::array<std::uint8_t, 12>;
std::string to_string(const ParticipantId& id);  ///< hexadecimal

inline ParticipantId participant_of(const WriterId& endpoint) {
  ParticipantId id{};
  std::copy_n(endpoint.begin(), id.size(), id.begin());
  return id;
}

}  // namespace rtd::bus
