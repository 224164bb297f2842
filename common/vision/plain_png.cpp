// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The file format: W3C, Portable Network Graphics (PNG) Specification, 2003.
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <opencv2/core/hal/intrin.hpp>
#include <string_view>

#include "common/vision/image_decoders.hpp"

namespace rtd::vision {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kSignatureBytes = 8, kHeaderBytes = 13;
constexpr std::uint32_t kMaxSide = 32768;
constexpr std::uint8_t kGrey = 0, kColor = 2;  // colour types

std::uint32_t number_at(Bytes bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24U | std::uint32_t{bytes[at + 1]} << 16U | std::uint32_t{bytes[at + 2]} << 8U |
         bytes[at + 3];
}

struct Chunk {
  std::string_view type;
  Bytes data;
};

/// Takes the next chunk off the front; none if it is damaged or cut off.
std::optional<Chunk> take_chunk(Bytes& bytes) {
  constexpr std::size_t kFrame = 12;  // length, type and CRC
  if (bytes.size() < kFrame) return std::nullopt;
  const std::size_t size = number_at(bytes, 0);
  if (size > bytes.size() - kFrame) return std::nullopt;
  const Bytes typed = bytes.subspan(4, 4 + size);
  if (::libdeflate_crc32(0, typed.data(), typed.size()) != number_at(bytes, 8 + size)) return std::nullopt;
  bytes = bytes.subspan(kFrame + size);
  return Chunk{{reinterpret_cast<const char*>(typed.data()), 4}, typed.subspan(4)};
}

struct Header {
  std::uint32_t width, height;
  int type;  ///< of the pixels
  std::size_t row_bytes() const { return std::size_t{width} * CV_ELEM_SIZE(type); }
};

std::optional<Header> read_header(const Chunk& chunk) {
  if (chunk.type != "IHDR" || chunk.data.size() != kHeaderBytes) return std::nullopt;
  const std::uint8_t bits = chunk.data[8], color = chunk.data[9];
  const bool plain = chunk.data[10] == 0 && chunk.data[11] == 0 && chunk.data[12] == 0;  // not interlaced
  const Header header{number_at(chunk.data, 0), number_at(chunk.data, 4),
                      color == kColor ? CV_8UC3 : (bits == 16 ? CV_16UC1 : CV_8UC1)};
  const bool known = (color == kGrey && (bits == 8 || bits == 16)) || (color == kColor && bits == 8);
  const bool has_size = header.width > 0 && header.height > 0 && header.width <= kMaxSide && header.height <= kMaxSide;
  if (!plain || !known || !has_size) return std::nullopt;
  return header;
}

bool is_allowed(const Header& header, std::size_t file_bytes, const DecodeRules& rules) {
  const std::int64_t pixels = std::int64_t{header.width} * header.height;
  if (pixels > rules.max_pixels) return false;
  const std::int64_t stored_bytes = pixels * CV_ELEM_SIZE(header.type);
  if (stored_bytes / kMaxBytesPerByte > static_cast<std::int64_t>(file_bytes)) return false;
  switch (rules.pixels) {
    case PixelsAs::kStored:
      return true;
    case PixelsAs::kBgr:
      return header.type == CV_8UC3;
    case PixelsAs::kGrey:
      return header.type == CV_8UC1;
  }
  return false;
}

/// The compressed pixels of all chunks; none if there are others that change the pixels, or the end is missing.
std::optional<std::vector<std::uint8_t>> gather(Bytes chunks) {
  std::vector<std::uint8_t> compressed;
  compressed.reserve(chunks.size());
  for (;;) {
    const std::optional<Chunk> chunk = take_chunk(chunks);
    if (!chunk || chunk->type == "tRNS") return std::nullopt;
    if (chunk->type == "IEND") return compressed;
    const bool critical = (chunk->type[0] & 0x20) == 0;
    if (chunk->type == "IDAT") {
      compressed.insert(compressed.end(), chunk->data.begin(), chunk->data.end());
    } else if (critical && chunk->type != "PLTE") {  // of a colour image, a palette is a suggestion
      return std::nullopt;
    }
  }
}

bool inflate(const std::vector<std::uint8_t>& compressed, std::span<std::uint8_t> to) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&::libdeflate_free_decompressor)> decompressor(
      ::libdeflate_alloc_decompressor(), ::libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  std::size_t taken = 0;
  const libdeflate_result result = ::libdeflate_zlib_decompress_ex(
      decompressor.get(), compressed.data(), compressed.size(), to.data(), to.size(), &taken, nullptr);
  return result == LIBDEFLATE_SUCCESS && taken == compressed.size();
}

/// Of three neighbours that which is nearest to left + above - corner (section 9.4 of the specification).
int paeth(int left, int above, int corner) {
  const int from_left = std::abs(above - corner), from_above = std::abs(left - corner),
            from_corner = std::abs(left + above - 2 * corner);
  if (from_left <= from_above && from_left <= from_corner) return left;
  return from_above <= from_corner ? above : corner;
}

/// Adds predict(left, above, corner) to the bytes of a row. The neighbours stay in registers.
template <std::size_t kPixelBytes, class Predict>
void add_predictions(std::uint8_t* __restrict row, const std::uint8_t* __restrict above, std::size_t size,
                     const Predict& predict) {
  std::array<std::uint8_t, kPixelBytes> left{}, corner{};
  for (std::size_t i = 0; i < size; i += kPixelBytes) {
    for (std::size_t k = 0; k < kPixelBytes; ++k) {
      left[k] = static_cast<std::uint8_t>(row[i + k] + predict(left[k], above[i + k], corner[k]));
      corner[k] = above[i + k];
      row[i + k] = left[k];
    }
  }
}

/// Adds to every pixel of 16 bits the one before, eight at a time: sums over two, four and eight of them.
void add_left_of_two_bytes(std::uint8_t* row, std::size_t size) {
  std::size_t i = 0;
#if CV_SIMD128
  cv::v_uint16x8 last = cv::v_setzero_u16();
  for (; i + 16 <= size; i += 16) {
    cv::v_uint8x16 sum = cv::v_load(row + i);
    sum = cv::v_add_wrap(sum, cv::v_rotate_left<2>(sum));
    sum = cv::v_add_wrap(sum, cv::v_rotate_left<4>(sum));
    sum = cv::v_add_wrap(sum, cv::v_rotate_left<8>(sum));
    sum = cv::v_add_wrap(sum, cv::v_reinterpret_as_u8(last));
    cv::v_store(row + i, sum);
    last = cv::v_setall_u16(cv::v_extract_n<7>(cv::v_reinterpret_as_u16(sum)));
  }
#endif
  for (i = std::max<std::size_t>(i, 2); i < size; ++i) row[i] = static_cast<std::uint8_t>(row[i] + row[i - 2]);
}

template <std::size_t kPixelBytes>
bool unfilter(std::uint8_t filter, std::uint8_t* __restrict row, const std::uint8_t* __restrict above,
              std::size_t size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      if constexpr (kPixelBytes == 2) {
        add_left_of_two_bytes(row, size);
      } else {
        add_predictions<kPixelBytes>(row, above, size, [](int left, int, int) { return left; });
      }
      return true;
    case 2:
      for (std::size_t i = 0; i < size; ++i) row[i] = static_cast<std::uint8_t>(row[i] + above[i]);
      return true;
    case 3:
      add_predictions<kPixelBytes>(row, above, size, [](int left, int up, int) { return (left + up) / 2; });
      return true;
    case 4:
      add_predictions<kPixelBytes>(row, above, size, paeth);
      return true;
    default:
      return false;
  }
}

void copy_row(const std::uint8_t* __restrict from, std::size_t size, int type, std::uint8_t* __restrict to) {
  if (type == CV_8UC1) {
    std::memcpy(to, from, size);
  } else if (type == CV_16UC1) {  // high byte first
    auto* __restrict units = reinterpret_cast<std::uint16_t*>(to);
    for (std::size_t i = 0; i < size / 2; ++i)
      units[i] = static_cast<std::uint16_t>(from[2 * i] << 8U | from[2 * i + 1]);
  } else {
    for (std::size_t i = 0; i < size; i += 3) {
      to[i] = from[i + 2];
      to[i + 1] = from[i + 1];
      to[i + 2] = from[i];
    }
  }
}

/// `filtered`: for every row the number of its filter, then its bytes.
bool unfilter_into(std::span<std::uint8_t> filtered, const Header& header, cv::Mat& pixels) {
  const std::size_t size = header.row_bytes();
  const std::vector<std::uint8_t> nothing(size, 0);
  const std::uint8_t* above = nothing.data();
  const auto unfilter_row =
      header.type == CV_8UC1 ? unfilter<1> : (header.type == CV_16UC1 ? unfilter<2> : unfilter<3>);
  for (int y = 0; y < pixels.rows; ++y) {
    std::uint8_t* row = filtered.data() + static_cast<std::size_t>(y) * (size + 1) + 1;
    if (!unfilter_row(row[-1], row, above, size)) return false;
    copy_row(row, size, header.type, pixels.ptr(y));
    above = row;
  }
  return true;
}

}  // namespace

std::optional<cv::Mat> decode_plain_png(Bytes bytes, const DecodeRules& rules) {
  Bytes chunks = bytes.subspan(std::min(kSignatureBytes, bytes.size()));
  const std::optional<Chunk> first = take_chunk(chunks);
  const std::optional<Header> header = first ? read_header(*first) : std::nullopt;
  if (!header || !is_allowed(*header, bytes.size(), rules)) return std::nullopt;
  const std::optional<std::vector<std::uint8_t>> compressed = gather(chunks);
  if (!compressed) return std::nullopt;
  const std::size_t size = (header->row_bytes() + 1) * header->height;
  const std::unique_ptr<std::uint8_t[]> filtered(new std::uint8_t[size]);  // not set to zero first
  if (!inflate(*compressed, {filtered.get(), size})) return std::nullopt;
  cv::Mat pixels(static_cast<int>(header->height), static_cast<int>(header->width), header->type);
  if (!unfilter_into({filtered.get(), size}, *header, pixels)) return std::nullopt;
  return pixels;
}

}  // namespace rtd::vision
