// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "common/vision/image_codecs.hpp"

namespace rtd::camera {

/// For messages.
inline constexpr const char* kDepthFormats =
    "16-bit PNG, PGM, TIFF (16-bit or 32-bit float), EXR (uncompressed, RLE, ZIP), npy";

/// Depth of a folder's file as it is stored: CV_16UC1 or CV_32FC1 (npy's other numbers become one of the two). PNG is
/// decoded as it is, whatever it has. `problem` says why there is none. Reads nothing outside the bytes and takes no
/// memory for more pixels than a frame may have. Thread-safe.
vision::DecodedImage decode_depth_values(std::span<const std::uint8_t> bytes);

/// PPM (P6, 8 bits) as CV_8UC3 BGR; other formats as vision::decode_image().
vision::DecodedImage decode_color_values(std::span<const std::uint8_t> bytes);

/// The parts of decode_depth_values(). TIFF: classic, strips or tiles, uncompressed, PackBits, LZW or deflate, with
/// predictors (TIFF 6.0, Adobe's supplement 2 and note 3). EXR: one part in scan lines, the channel Z, Y, R or the
/// first, half or float (openexr.com, "OpenEXR File Layout").
vision::DecodedImage decode_tiff(std::span<const std::uint8_t> bytes);
vision::DecodedImage decode_exr(std::span<const std::uint8_t> bytes);
vision::DecodedImage decode_npy(std::span<const std::uint8_t> bytes);
vision::DecodedImage decode_pnm(std::span<const std::uint8_t> bytes);

/// True for an image of up to a frame's pixels, or so many times that.
bool is_raster_size(std::int64_t width, std::int64_t height, std::int64_t times = 1);

/// The `size` bytes that a zlib or gzip stream holds; fewer, or none: it is damaged. Takes no memory when the stream is
/// too short to hold them.
std::vector<std::uint8_t> inflate_at_most(std::span<const std::uint8_t> packed, std::size_t size);

}  // namespace rtd::camera
