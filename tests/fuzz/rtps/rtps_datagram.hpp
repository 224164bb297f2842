// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace rtd::fuzz {

using Bytes = std::vector<std::byte>;

/// What it says and whose it is: the submessages with reader and writer. Alike for the fragments of a stream of images.
std::string kind_of(const Bytes& datagram);

/// Makes the datagram one for whoever gets it: the participant in INFO_DESTINATION becomes "any", and so do the readers
/// that DATA, DATA_FRAG, HEARTBEAT and GAP name, half of the time. Otherwise a receiver drops it unread.
void address_to_any_reader(Bytes& datagram, std::mt19937_64& random);

/// Changes what RTPS parsers trust: submessage lengths and flags, sequence numbers and bitmap sizes, fragment numbers,
/// lengths and contents of parameters, CDR headers; or the order and number of submessages.
void mutate_submessages(Bytes& datagram, std::mt19937_64& random);

}  // namespace rtd::fuzz
