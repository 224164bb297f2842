// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <optional>

#include "common/vision/jpeg_codec.hpp"

namespace rtd::vision {
namespace {

/// Numbers of a TIFF file in its byte order; nothing outside the file.
class Tiff {
 public:
  explicit Tiff(std::span<const std::uint8_t> bytes) : bytes_(bytes), little_(!bytes.empty() && bytes[0] == 'I') {}

  std::optional<std::uint32_t> number(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes_[little_ ? at + size - 1 - i : at + i];
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  bool little_;
};

}  // namespace

// A TIFF header (order, 42, offset of the first directory), then entries of 12 bytes: tag, type, count, value.
int exif_orientation(std::span<const std::uint8_t> app1) {
  constexpr std::array<std::uint8_t, 6> kExif = {'E', 'x', 'i', 'f', 0, 0};
  constexpr std::uint32_t kOrientation = 0x0112;
  if (app1.size() < kExif.size() || !std::ranges::equal(app1.first(kExif.size()), kExif)) return 1;
  const Tiff tiff(app1.subspan(kExif.size()));
  const std::optional<std::uint32_t> directory = tiff.number(4, 4);
  const std::optional<std::uint32_t> entries = directory ? tiff.number(*directory, 2) : std::nullopt;
  for (std::uint32_t i = 0; i < entries.value_or(0); ++i) {
    const std::size_t entry = std::size_t{*directory} + 2 + std::size_t{12} * i;
    if (tiff.number(entry, 2) != kOrientation) continue;
    const std::uint32_t value = tiff.number(entry + 8, 2).value_or(1);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

cv::Mat turn_upright(const cv::Mat& image, int orientation) {
  constexpr int kKeep = 9;
  constexpr std::array<int, 9> kFlips = {kKeep, kKeep, 1, -1, 0, kKeep, 1, -1, 0};  // cv::flip's codes
  cv::Mat turned = image;
  if (orientation >= 5) cv::transpose(image, turned);
  const int flip = kFlips.at(static_cast<std::size_t>(orientation));
  if (flip == kKeep) return turned;
  cv::Mat flipped;
  cv::flip(turned, flipped, flip);
  return flipped;
}

}  // namespace rtd::vision
