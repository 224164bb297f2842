// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/depth_formats.hpp"

#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;
using vision::DecodedImage;

static_assert(std::endian::native == std::endian::little, "rasters are read as they lie in memory");

std::string_view as_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

DecodedImage truncated() {
  return {{}, "is truncated"};
}

/// The text between `name` and what ends a value of Python's dictionary.
std::string_view entry_of(std::string_view header, std::string_view name, std::string_view ends) {
  const std::size_t at = header.find(name);
  if (at == std::string_view::npos) return {};
  header.remove_prefix(at + name.size());
  const std::size_t begin = header.find_first_not_of("': ");
  if (begin == std::string_view::npos) return {};
  header.remove_prefix(begin);
  return header.substr(0, header.find_first_of(ends));
}

std::vector<std::int64_t> sides_of(std::string_view shape) {
  std::vector<std::int64_t> sides;
  for (const io::TextLine& line : io::split_lines(shape, "(), ")) {
    for (const std::string& field : line.fields) {
      const double side = io::parse_number(field).value_or(0);
      if (side == 1 && line.fields.size() > 2) continue;  // (480, 640, 1)
      sides.push_back(side >= 0 && side < 1e6 ? static_cast<std::int64_t>(side) : 0);
    }
  }
  return sides;
}

template <class Stored>
double value_at(Bytes bytes, std::size_t index) {
  Stored value;
  std::memcpy(&value, bytes.data() + index * sizeof(Stored), sizeof(Stored));
  return static_cast<double>(value);
}

double half_at(Bytes bytes, std::size_t index) {
  return static_cast<double>(imath_half_to_float(static_cast<std::uint16_t>(value_at<std::uint16_t>(bytes, index))));
}

struct NumberType {
  std::string_view name;
  std::size_t bytes;
  double (*value)(Bytes, std::size_t);
};
constexpr std::array kNumberTypes = {NumberType{"<f4", 4, value_at<float>},
                                     NumberType{"<f8", 8, value_at<double>},
                                     NumberType{"<f2", 2, half_at},
                                     NumberType{"<u2", 2, value_at<std::uint16_t>},
                                     NumberType{"<i2", 2, value_at<std::int16_t>},
                                     NumberType{"<i4", 4, value_at<std::int32_t>},
                                     NumberType{"<u4", 4, value_at<std::uint32_t>},
                                     NumberType{"<i8", 8, value_at<std::int64_t>}};

/// The numbers of a netpbm header, behind "P5"; comments are passed over.
std::optional<std::array<std::int64_t, 3>> pnm_header(std::string_view text, std::size_t& at) {
  std::array<std::int64_t, 3> numbers{};
  for (std::int64_t& number : numbers) {
    while (at < text.size() && (std::isspace(static_cast<unsigned char>(text[at])) != 0 || text[at] == '#'))
      at = text[at] == '#' ? std::min(text.find('\n', at), text.size()) : at + 1;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && number < 1'000'000; ++at)
      number = number * 10 + (text[at] - '0');
  }
  ++at;  // one blank
  if (at > text.size()) return std::nullopt;
  return numbers;
}

cv::Mat pnm_pixels(const std::uint8_t* from, cv::Size size_px, bool color, bool wide) {
  cv::Mat pixels(size_px, color ? CV_8UC3 : CV_16UC1);
  for (int row = 0; row < pixels.rows; ++row) {
    for (int column = 0; column < pixels.cols; ++column) {
      if (color) {
        pixels.at<cv::Vec3b>(row, column) = {from[2], from[1], from[0]};
        from += 3;
      } else {
        pixels.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(wide ? from[0] << 8 | from[1] : from[0]);
        from += wide ? 2 : 1;
      }
    }
  }
  return pixels;
}

}  // namespace

bool is_raster_size(std::int64_t width, std::int64_t height, std::int64_t times) {
  const std::int64_t most = times * vision::DecodeRules::kMaxStreamPixels;
  return width > 0 && height > 0 && width <= most && height <= most && width * height <= most;
}

std::vector<std::uint8_t> inflate_at_most(Bytes packed, std::size_t size) {
  constexpr std::size_t kMostPerByte = 1032;  // of deflate: runs of 258 bytes in two bits
  if (size / kMostPerByte > packed.size()) return {};
  constexpr int kEitherHeader = 32 + MAX_WBITS;
  std::vector<std::uint8_t> bytes(size);
  z_stream stream{};
  stream.next_in = const_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<uInt>(size);
  if (inflateInit2(&stream, kEitherHeader) != Z_OK) return {};
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (result != Z_STREAM_END && result != Z_BUF_ERROR) return {};
  bytes.resize(stream.total_out);
  return bytes;
}

DecodedImage decode_npy(Bytes bytes) {
  if (bytes.size() < 12) return truncated();
  const bool wide = bytes[6] > 1;
  const std::size_t begin = wide ? 12 : 10;
  std::size_t length = static_cast<std::size_t>(bytes[8] | bytes[9] << 8);
  if (wide) length |= static_cast<std::size_t>(bytes[10]) << 16 | static_cast<std::size_t>(bytes[11]) << 24;
  if (length > bytes.size() - begin) return truncated();
  const std::string_view header = as_text(bytes.subspan(begin, length));
  const std::string_view name = entry_of(header, "descr", "',}");
  const auto type = std::ranges::find(kNumberTypes, name, &NumberType::name);
  if (type == kNumberTypes.end())
    return {{}, "holds numbers of type '" + std::string(name) + "', not floats or integers"};
  const std::vector<std::int64_t> sides = sides_of(entry_of(header, "shape", ")}"));
  if (sides.size() != 2 || !is_raster_size(sides[1], sides[0])) return {{}, "is not an array of (height, width)"};
  if (entry_of(header, "fortran_order", ",}").starts_with("True"))
    return {{}, "is stored by columns: save it with order='C'"};
  const Bytes values = bytes.subspan(begin + length);
  if (values.size() / type->bytes < static_cast<std::size_t>(sides[0] * sides[1])) return truncated();
  const bool units = type->name == "<u2";
  cv::Mat pixels(static_cast<int>(sides[0]), static_cast<int>(sides[1]), units ? CV_16UC1 : CV_32FC1);
  for (std::size_t i = 0; i < pixels.total(); ++i) {
    const double value = type->value(values, i);
    units ? void(pixels.ptr<std::uint16_t>()[i] = static_cast<std::uint16_t>(value))
          : void(pixels.ptr<float>()[i] = static_cast<float>(value));
  }
  return {pixels, {}};
}

DecodedImage decode_pnm(Bytes bytes) {
  std::size_t at = 2;
  const bool color = bytes[1] == '6';
  const auto header = pnm_header(as_text(bytes), at);
  if (!header) return truncated();
  const auto [width, height, highest] = *header;
  if (!is_raster_size(width, height) || highest < 1 || highest > 65535) return {{}, "has a damaged header"};
  const bool wide = highest > 255;
  if (color && wide) return {{}, "is colour of 16 bits; 8 bits can be read"};
  const std::size_t needed = static_cast<std::size_t>(width * height) * (color ? 3 : wide ? 2 : 1);
  if (bytes.size() - at < needed) return truncated();
  return {pnm_pixels(bytes.data() + at, {static_cast<int>(width), static_cast<int>(height)}, color, wide), {}};
}

DecodedImage decode_depth_values(Bytes bytes) {
  const std::string_view text = as_text(bytes);
  if (bytes.empty()) return {{}, "is empty"};
  if (text.starts_with("P5")) return decode_pnm(bytes);
  if (text.starts_with("\x93NUMPY")) return decode_npy(bytes);
  if (text.starts_with(std::string_view("II*\0", 4)) || text.starts_with(std::string_view("MM\0*", 4)))
    return decode_tiff(bytes);
  if (text.starts_with("\x76\x2f\x31\x01")) return decode_exr(bytes);
  if (vision::format_of(bytes) == vision::ImageFormat::kUnknown)
    return {{}, std::string("cannot be decoded as depth; readable: ") + kDepthFormats};
  return vision::decode_image(
      bytes, {.pixels = vision::PixelsAs::kStored, .max_pixels = vision::DecodeRules::kMaxStreamPixels});
}

DecodedImage decode_color_values(Bytes bytes) {
  if (as_text(bytes).starts_with("P6")) return decode_pnm(bytes);
  return vision::decode_image(bytes,
                              {.pixels = vision::PixelsAs::kBgr, .max_pixels = vision::DecodeRules::kMaxStreamPixels});
}

}  // namespace rtd::camera
