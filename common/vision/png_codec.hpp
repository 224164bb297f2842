// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/vision/image_codecs.hpp"

namespace rtd::vision {

/// More pixels than so many bytes for each byte of the file are refused; deflate reaches 1032.
inline constexpr std::int64_t kMaxBytesPerByte = 1100;

/// As decode_image(), for bytes that begin as a PNG.
DecodedImage decode_png(std::span<const std::uint8_t> bytes, const DecodeRules& rules);

}  // namespace rtd::vision
