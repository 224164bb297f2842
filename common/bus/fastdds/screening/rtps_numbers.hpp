// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/bus/fastdds/screening/sequence_guard.hpp"

namespace rtd::bus {

struct WriterNumber {
  WriterGuid writer;
  std::uint64_t number;
};

/// The largest sequence number that DATA, DATA_FRAG, HEARTBEAT, HEARTBEAT_FRAG and GAP of a message name, for each
/// writer. The message is one by is_rtps_message(); submessages too short for their numbers are passed over.
std::vector<WriterNumber> sequence_numbers_of(std::span<const std::byte> message);

}  // namespace rtd::bus
