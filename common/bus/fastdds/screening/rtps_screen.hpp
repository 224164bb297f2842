// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "common/bus/fastdds/screening/sequence_guard.hpp"

namespace rtd::bus {

/// Whether a datagram has the frame of an RTPS message: header, known submessages one behind the other, each of a whole
/// number of words, the last one ending with the datagram. What is in the submessages is not looked at.
bool is_rtps_message(std::span<const std::byte> datagram);

/// Looks at the datagrams of a participant, one at a time.
class RtpsScreen {
 public:
  /// Whether it is an RTPS message whose fragments are whole and whose sequence numbers are plausible.
  bool passes(std::span<const std::byte> datagram);

 private:
  SequenceGuard guard_;
};

}  // namespace rtd::bus
