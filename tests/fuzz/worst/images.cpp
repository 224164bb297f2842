// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "common/camera/depth_formats.hpp"
#include "common/vision/image_codecs.hpp"
#include "tests/fuzz/worst/worst_case.hpp"

namespace rtd::worst {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class Number>
void put(Bytes& bytes, Number number) {
  const auto* const at = reinterpret_cast<const std::uint8_t*>(&number);
  bytes.insert(bytes.end(), at, at + sizeof(number));
}

void put(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

/// Zeros, packed.
Bytes zeros(std::size_t count) {
  const Bytes plain(count);
  Bytes packed(compressBound(count));
  auto size = static_cast<uLongf>(packed.size());
  compress2(packed.data(), &size, plain.data(), count, 1);
  packed.resize(size);
  return packed;
}

struct Exr {
  std::uint32_t channels;
  std::int32_t width, height;
  std::uint8_t compression;  ///< 0: none, 3: ZIP
  bool one_block;            ///< for all lines
};

void attribute(Bytes& bytes, const std::string& name, const std::string& type, const Bytes& value) {
  put(bytes, bytes_of(name + '\0' + type + '\0'));
  put(bytes, static_cast<std::uint32_t>(value.size()));
  put(bytes, value);
}

Bytes exr(const Exr& of) {
  Bytes bytes = {0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0}, channels, window;
  for (std::uint32_t i = 0; i < of.channels; ++i) {
    put(channels, bytes_of("c" + std::to_string(i)));
    put(channels, Bytes{0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  }
  channels.push_back(0);
  for (const std::int32_t number : {0, 0, of.width - 1, of.height - 1}) put(window, number);
  attribute(bytes, "channels", "chlist", channels);
  attribute(bytes, "compression", "compression", {of.compression});
  attribute(bytes, "dataWindow", "box2i", window);
  attribute(bytes, "displayWindow", "box2i", window);
  attribute(bytes, "lineOrder", "lineOrder", {0});
  attribute(bytes, "pixelAspectRatio", "float", {0, 0, 0x80, 0x3F});
  attribute(bytes, "screenWindowCenter", "v2f", Bytes(8));
  attribute(bytes, "screenWindowWidth", "float", {0, 0, 0x80, 0x3F});
  bytes.push_back(0);
  const std::int32_t lines = of.compression == 3 ? 16 : 1, blocks = (of.height + lines - 1) / lines;
  const std::size_t unpacked =
      std::size_t{of.channels} * 4 * static_cast<std::size_t>(of.width * std::min(lines, of.height));
  const Bytes packed = of.compression == 3 ? zeros(unpacked) : Bytes(unpacked);
  const std::size_t first = bytes.size() + static_cast<std::size_t>(blocks) * 8;
  for (std::int32_t i = 0; i < blocks; ++i)
    put(bytes, std::uint64_t{first + (of.one_block ? 0 : static_cast<std::size_t>(i) * (packed.size() + 8))});
  for (std::int32_t i = 0; i < (of.one_block ? 1 : blocks); ++i) {
    put(bytes, i * lines);
    put(bytes, static_cast<std::uint32_t>(packed.size()));
    put(bytes, packed);
  }
  return bytes;
}

void field(Bytes& bytes, std::uint16_t tag, std::uint32_t count, std::uint32_t value) {
  put(bytes, tag);
  put(bytes, std::uint16_t{4});
  put(bytes, count);
  put(bytes, value);
}

struct Tiff {
  std::uint32_t width, height, tile_width, tile_height;
  std::uint32_t compression;
  Bytes tile;
  bool one_tile;  ///< for all places
};

Bytes tiff(const Tiff& of) {
  Bytes bytes = {'I', 'I', '*', 0, 8, 0, 0, 0, 10, 0};
  const std::uint32_t tiles =
      ((of.width + of.tile_width - 1) / of.tile_width) * ((of.height + of.tile_height - 1) / of.tile_height);
  const std::uint32_t lists = 8 + 2 + 10 * 12, first = lists + tiles * 8;
  const auto size = static_cast<std::uint32_t>(of.tile.size());
  field(bytes, 256, 1, of.width);
  field(bytes, 257, 1, of.height);
  field(bytes, 258, 1, 32);
  field(bytes, 259, 1, of.compression);
  field(bytes, 277, 1, 1);
  field(bytes, 322, 1, of.tile_width);
  field(bytes, 323, 1, of.tile_height);
  field(bytes, 324, tiles, tiles == 1 ? first : lists);
  field(bytes, 325, tiles, tiles == 1 ? size : lists + tiles * 4);
  field(bytes, 339, 1, 3);
  for (std::uint32_t i = 0; i < tiles; ++i) put(bytes, first + (of.one_tile ? 0 : i * size));
  for (std::uint32_t i = 0; i < tiles; ++i) put(bytes, size);
  for (std::uint32_t i = 0; i < (of.one_tile ? 1 : tiles); ++i) put(bytes, of.tile);
  return bytes;
}

/// Every entry of the directory has all of the file as its values.
Bytes tiff_of_fields(std::size_t size) {
  Bytes bytes = {'I', 'I', '*', 0, 8, 0, 0, 0, 0xFF, 0xFF};
  for (int i = 0; i < 0xFFFF && bytes.size() < size; ++i)
    field(bytes, i % 2 == 0 ? 273 : 256, static_cast<std::uint32_t>(size / 4 - 4), 8);
  bytes.resize(size + 8);
  return bytes;
}

/// Codes of 9 bits that begin again.
Bytes lzw_clears(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size * 8; i += 9)
    bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | 0x80U >> (i % 8));
  return bytes;
}

void chunk(Bytes& bytes, const std::string& type, const Bytes& data) {
  const auto big = [&](std::uint32_t number) { put(bytes, __builtin_bswap32(number)); };
  big(static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = bytes.size();
  put(bytes, bytes_of(type));
  put(bytes, data);
  big(static_cast<std::uint32_t>(crc32(0, bytes.data() + begin, static_cast<uInt>(bytes.size() - begin))));
}

/// A PNG of zeros, grey with 16 bits; `texts` more packed ones of 1 MiB each.
Bytes png(std::uint32_t width, std::uint32_t height, std::size_t texts, std::uint8_t interlaced,
          std::uint8_t color = 0) {
  Bytes bytes = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}, header;
  put(header, __builtin_bswap32(width));
  put(header, __builtin_bswap32(height));
  put(header, Bytes{16, color, 0, 0, interlaced});
  chunk(bytes, "IHDR", header);
  Bytes text = bytes_of(std::string("k\0\0", 3));
  put(text, zeros((1 << 20) - 100));
  for (std::size_t i = 0; i < texts; ++i) chunk(bytes, "zTXt", text);
  const std::size_t row = std::size_t{width} * (color == 6 ? 8 : color == 2 ? 6 : 2) + 1;
  chunk(bytes, "IDAT", zeros(row * height + (interlaced != 0 ? std::size_t{height} * 2 : 0)));
  chunk(bytes, "IEND", {});
  return bytes;
}

Bytes jpeg(int width, int height, bool progressive) {
  Bytes bytes;
  cv::imencode(".jpg", cv::Mat(height, width, CV_8UC3, cv::Scalar(7, 8, 9)), bytes,
               {cv::IMWRITE_JPEG_PROGRESSIVE, progressive ? 1 : 0, cv::IMWRITE_JPEG_QUALITY, 5});
  return bytes;
}

/// The last scan again and again.
Bytes jpeg_of_scans(std::size_t size) {
  Bytes bytes = jpeg(3840, 2160, true);
  const Bytes mark = {0xFF, 0xDA};
  const auto scan = std::find_end(bytes.begin(), bytes.end(), mark.begin(), mark.end());
  const Bytes again(scan, bytes.end() - 2);
  bytes.resize(bytes.size() - 2);
  for (int i = 0; i < 60 && bytes.size() < size; ++i) put(bytes, again);
  put(bytes, Bytes{0xFF, 0xD9});
  return bytes;
}

Bytes npy(const std::string& shape, std::size_t size) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + shape + "), }\n";
  Bytes bytes = bytes_of("\x93NUMPY");
  put(bytes, Bytes{2, 0});
  put(bytes, static_cast<std::uint32_t>(header.size()));
  put(bytes, bytes_of(header));
  bytes.resize(std::max(size, bytes.size()));
  return bytes;
}

Case depth(const std::string& name, const Bytes& bytes) {
  const auto shared = std::make_shared<const Bytes>(bytes);
  return {"image: " + name, [shared] { camera::decode_depth_values(*shared); }};
}

Case photo(const std::string& name, const Bytes& bytes) {
  const auto shared = std::make_shared<const Bytes>(bytes);
  return {"photo: " + name, [shared] { vision::decode_image(*shared); }};
}

}  // namespace

std::vector<Case> images(std::size_t bytes) {
  const auto size = static_cast<std::int32_t>(bytes);
  const auto count = static_cast<std::uint32_t>(bytes);
  return {
      depth("EXR of 150 channels", exr({150, 640, 480, 3, true})),
      depth("EXR of 150 channels, all blocks", exr({150, 640, 480, 3, false})),
      depth("EXR of 30 channels, all blocks", exr({30, 1920, 480, 3, false})),
      depth("EXR of 20000 channels", exr({count / 25, 640, 480, 3, true})),
      depth("EXR of many channels and lines", exr({count / 50, 1, size / 50, 0, true})),
      depth("EXR of one line", exr({4, 3840 * 2160, 1, 3, false})),
      depth("EXR of lines of one pixel", exr({1, 1, size / 20, 0, false})),
      depth("TIFF of many tiles at one place",
            tiff({8'298'400, 1, 506, 16384, 8, zeros(std::size_t{506} * 16384 * 4), true})),
      depth("TIFF of many tiles", tiff({count / 40 * 16, 1, 16, 16384, 8, zeros(1 << 20), true})),
      depth("TIFF of one large tile", tiff({16, 16, 2048, 4048, 8, zeros(std::size_t{2048} * 4048 * 4), true})),
      depth("TIFF of tiles that are one pixel", tiff({count / 16, 1, 1, 1, 1, Bytes(4), false})),
      depth("TIFF of fields", tiff_of_fields(bytes)),
      depth("TIFF of LZW that begins again", tiff({2048, 2048, 2048, 2048, 5, lzw_clears(bytes), true})),
      depth("TIFF of bytes that say nothing", tiff({2048, 2048, 2048, 2048, 32773, Bytes(bytes, 0x80), true})),
      depth("npy of many sides", npy(repeated("1,", bytes), bytes)),
      depth("npy of a large shape", npy("2160, 3840", bytes)),
      depth("PGM of comments", bytes_of("P5 " + repeated("#\n", bytes))),
      depth("PNG of zeros", png(3840, 2160, 0, 0)),
      depth("PNG of colour and alpha, interlaced", png(3840, 2160, 0, 1, 6)),
      depth("PNG of packed texts", png(640, 480, bytes / 1100, 1)),
      depth("JPEG", jpeg(3840, 2160, false)),
      depth("JPEG of many scans", jpeg_of_scans(bytes)),
      photo("PNG of zeros", png(8192, 8192, 0, 0)),
      photo("PNG of colour, interlaced", png(8192, 8192, 0, 1, 2)),
      photo("progressive JPEG", jpeg(8192, 8192, true)),
  };
}

}  // namespace rtd::worst
