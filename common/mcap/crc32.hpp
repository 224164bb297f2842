// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/mcap/records.hpp"

namespace rtd::mcap {

/// CRC-32 (IEEE 802.3, as zlib computes it) of what `crc` is the CRC of (0: nothing) followed by `data`.
std::uint32_t crc32(ByteView data, std::uint32_t crc = 0);

/// CRC of two byte strings in a row from their CRCs and the size of the second, without reading either again.
std::uint32_t crc32_combine(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

}  // namespace rtd::mcap
