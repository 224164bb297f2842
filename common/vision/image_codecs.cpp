// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/image_codecs.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/vision/image_decoders.hpp"

namespace rtd::vision {
namespace {

bool starts_with(std::span<const std::uint8_t> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::ranges::equal(bytes.first(magic.size()), magic, {}, {},
                                                            [](char c) { return static_cast<std::uint8_t>(c); });
}

}  // namespace

ImageFormat format_of(std::span<const std::uint8_t> bytes) {
  if (starts_with(bytes, "\xFF\xD8\xFF")) return ImageFormat::kJpeg;
  if (starts_with(bytes, "\x89PNG\r\n\x1A\n")) return ImageFormat::kPng;
  return ImageFormat::kUnknown;
}

DecodedImage decode_image(std::span<const std::uint8_t> bytes, const DecodeRules& rules) {
  if (bytes.empty()) return {{}, "is empty"};
  const ImageFormat format = format_of(bytes);
  if (format == ImageFormat::kJpeg) return decode_jpeg(bytes, rules);
  if (rules.jpeg_only) return {{}, "is not a JPEG image"};
  if (format == ImageFormat::kPng) return decode_png(bytes, rules);
  return {{}, std::string("cannot be decoded as an image; readable: ") + kReadableFormats};
}

DecodedImage read_image(const std::filesystem::path& file, const DecodeRules& rules,
                        const std::filesystem::path& below) {
  try {
    const std::string content = io::read_file(file, io::kImage, below);
    return decode_image({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, rules);
  } catch (const io::IoError& error) {
    return {{}, error.what()};
  }
}

std::vector<std::uint8_t> encode_image(std::string extension, const cv::Mat& image) {
  std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return std::tolower(letter); });
  if (extension == ".png") return encode_png(image);
  if (extension == ".jpg" || extension == ".jpeg") return encode_jpeg(image);
  return {};
}

bool write_image(const std::filesystem::path& file, const cv::Mat& image, io::AtomicOptions options) {
  const std::vector<std::uint8_t> bytes = encode_image(file.extension().string(), image);
  if (bytes.empty()) return false;
  io::write_file(file, std::as_bytes(std::span(bytes)), options);
  return true;
}

}  // namespace rtd::vision
