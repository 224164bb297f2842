// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/vision/image_codecs.hpp"

/// What decode_image() is made of.
namespace rtd::vision {

/// As decode_image(), for bytes that begin as a JPEG.
DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const DecodeRules& rules);

/// More pixels than so many bytes for each byte of the file are refused; deflate reaches 1032.
inline constexpr std::int64_t kMaxBytesPerByte = 1100;

/// As decode_image(), for bytes that begin as a PNG.
DecodedImage decode_png(std::span<const std::uint8_t> bytes, const DecodeRules& rules);

/// Decodes what cameras and datasets write, in half of libpng's time: grey of 8 or 16 bits and colour of 8 bits, not
/// interlaced, without transparency, to the pixels that the file has (BGR for colour). None: it is another kind of PNG,
/// other pixels are asked for, the rules forbid it, or something is wrong with the file. libpng then decodes it, or
/// says why not.
std::optional<cv::Mat> decode_plain_png(std::span<const std::uint8_t> bytes, const DecodeRules& rules);

}  // namespace rtd::vision
