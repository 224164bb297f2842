// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/jpeg_size.hpp"

namespace rtd::vision {

// ITU T.81: markers are 0xFF and a code; all but a few carry a length; the frame header (SOFn) holds height and width.
cv::Size jpeg_size(std::span<const std::uint8_t> bytes) {
  const auto u16 = [&](std::size_t at) { return bytes[at] << 8 | bytes[at + 1]; };
  if (bytes.size() < 4 || u16(0) != 0xFFD8) return {};
  std::size_t at = 2;
  while (at + 9 < bytes.size() && bytes[at] == 0xFF) {
    const unsigned code = bytes[at + 1];
    const bool frame_header = code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
    if (frame_header) return {u16(at + 7), u16(at + 5)};
    at += code == 0xFF ? 1 : 2 + static_cast<std::size_t>(u16(at + 2));
  }
  return {};
}

}  // namespace rtd::vision
