// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/bytes.hpp"

#include <libdeflate.h>
#include <zlib.h>

namespace rtd::io {

std::uint32_t crc32(ByteView data, std::uint32_t crc) {
  if (data.empty()) return crc;  // a null pointer asks libdeflate for the start value
  return ::libdeflate_crc32(crc, data.data(), data.size());
}

std::uint32_t crc32_combine(std::uint32_t first, std::uint32_t second, std::uint64_t second_size) {
  return static_cast<std::uint32_t>(::crc32_combine64(first, second, static_cast<z_off64_t>(second_size)));
}

}  // namespace rtd::io
