// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/io/atomic_file.hpp"

namespace rtd::vision {

/// By their first bytes. A new format needs its name here, in format_of(), in kReadableFormats and in decode_image().
enum class ImageFormat { kUnknown, kJpeg, kPng };
ImageFormat format_of(std::span<const std::uint8_t> bytes);

/// For messages.
inline constexpr const char* kReadableFormats = "JPEG and PNG";

enum class PixelsAs {
  kBgr,     ///< CV_8UC3
  kGrey,    ///< CV_8UC1
  kStored,  ///< CV_8U or CV_16U with 1, 3 (BGR) or 4 (BGRA) channels: what the file has
};

/// What may be decoded. An image that claims more is refused by its header, before memory is taken for it.
struct DecodeRules {
  PixelsAs pixels = PixelsAs::kBgr;
  bool upright = false;                                                   ///< turn a photo as its EXIF data say
  bool jpeg_only = false;                                                 ///< as on the compressed topic
  std::int64_t max_pixels = kMaxFilePixels;                               ///< width x height
  static constexpr std::int64_t kMaxFilePixels = std::int64_t{64} << 20;  ///< photos; no side is above 32768 px
  static constexpr std::int64_t kMaxStreamPixels = 3840 * 2160;           ///< images of a camera, and from the bus
};

/// For images that other processes send.
inline constexpr DecodeRules kBusImages{.jpeg_only = true, .max_pixels = DecodeRules::kMaxStreamPixels};

/// Pixels, or why there are none: `problem` is a clause such as "is truncated".
struct DecodedImage {
  cv::Mat pixels;
  std::string problem;
};

/// The pixels that libjpeg-turbo (accurate DCT, smooth chroma) and libpng give. Refused: what is neither JPEG nor PNG,
/// headers beyond the rules or with far more pixels than the bytes can hold, damaged and truncated data, CMYK, and
/// progressive JPEGs of more than 64 scans. Throws only std::bad_alloc and cv::Exception for want of memory.
/// Thread-safe.
DecodedImage decode_image(std::span<const std::uint8_t> bytes, const DecodeRules& rules = {});

/// Reads and decodes a file, which must not lead out of the folder `below` (io::open_regular; empty: it may). `problem`
/// also says when it cannot be read.
DecodedImage read_image(const std::filesystem::path& file, const DecodeRules& rules = {},
                        const std::filesystem::path& below = {});

/// A CV_8UC3 (BGR) or CV_8UC1 image as a baseline JPEG with 4:2:0 chroma. quality: 1 to 100. Empty if the image has
/// another type or no pixels. Thread-safe.
std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality = 95);

/// An image of 8 or 16 bits with 1, 3 (BGR) or 4 (BGRA) channels as PNG with fast compression. Empty if it has another
/// type or no pixels. Thread-safe.
std::vector<std::uint8_t> encode_png(const cv::Mat& image);

/// By an extension: .png, .jpg or .jpeg in any case. Empty: another one, or the image cannot be encoded.
std::vector<std::uint8_t> encode_image(std::string extension, const cv::Mat& image);

/// Writes an image file as io::AtomicFile does, encoded by its extension. False: another extension than those of
/// encode_image(), or the image cannot be encoded. Throws io::IoError.
bool write_image(const std::filesystem::path& file, const cv::Mat& image, io::AtomicOptions options = {});

}  // namespace rtd::vision
