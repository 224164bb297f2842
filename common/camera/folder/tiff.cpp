// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "common/camera/folder/depth_formats.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Block = std::vector<std::uint8_t>;

/// What is said of the file; caught in decode_tiff().
class TiffError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class Tag : std::uint32_t {
  kWidth = 256,
  kHeight = 257,
  kBits = 258,
  kCompression = 259,
  kStripOffsets = 273,
  kSamples = 277,
  kRowsPerStrip = 278,
  kStripBytes = 279,
  kPredictor = 317,
  kTileWidth = 322,
  kTileHeight = 323,
  kTileOffsets = 324,
  kTileBytes = 325,
  kFormat = 339,
};

/// Numbers in the byte order of the file.
class TiffBytes {
 public:
  explicit TiffBytes(Bytes bytes) : bytes_(bytes), big_(bytes[0] == 'M') {}

  std::uint32_t number(std::size_t at, std::size_t size) const {
    const Bytes part = piece(at, size);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint32_t{part[i]} << 8 * (big_ ? size - 1 - i : i);
    return value;
  }
  Bytes piece(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) throw TiffError("is truncated");
    return bytes_.subspan(at, size);
  }
  bool big_endian() const { return big_; }

 private:
  Bytes bytes_;
  bool big_;
};

/// The values of a field of type SHORT or LONG, in the first directory; none when it has no such field.
std::vector<std::uint32_t> values_of(const TiffBytes& file, Tag tag) {
  constexpr std::uint32_t kShort = 3, kLong = 4, kMostValues = 1U << 20;
  const std::size_t directory = file.number(4, 4);
  const std::uint32_t entries = file.number(directory, 2);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + std::size_t{i} * 12;
    const std::uint32_t type = file.number(entry + 2, 2), count = file.number(entry + 4, 4);
    if (file.number(entry, 2) != static_cast<std::uint32_t>(tag)) continue;
    if ((type != kShort && type != kLong) || count > kMostValues) return {};
    const std::size_t size = type == kShort ? 2 : 4;
    const std::size_t at = count * size <= 4 ? entry + 8 : file.number(entry + 8, 4);
    file.piece(at, count * size);
    std::vector<std::uint32_t> values(count);
    for (std::uint32_t k = 0; k < count; ++k) values[k] = file.number(at + k * size, size);
    return values;
  }
  return {};
}

Block unpack_bits(Bytes packed, std::size_t size) {
  Block block;
  for (std::size_t at = 0; at < packed.size() && block.size() < size;) {
    const auto count = static_cast<std::int8_t>(packed[at++]);
    if (count >= 0) {
      const std::size_t run = std::min<std::size_t>(static_cast<std::size_t>(count) + 1, packed.size() - at);
      block.insert(block.end(), packed.begin() + static_cast<std::ptrdiff_t>(at),
                   packed.begin() + static_cast<std::ptrdiff_t>(at + run));
      at += run;
    } else if (count != -128 && at < packed.size()) {
      block.insert(block.end(), static_cast<std::size_t>(1 - count), packed[at++]);
    }
  }
  return block;
}

/// TIFF 6.0, section 13: codes of 9 to 12 bits, highest bit first, one code wider a code early.
class LzwReader {
 public:
  LzwReader(Bytes packed, std::size_t size) : packed_(packed), size_(size) { clear(); }

  Block read() {
    constexpr std::uint32_t kClear = 256, kEnd = 257;
    std::uint32_t previous = kEnd;
    for (std::uint32_t code = next(); code != kEnd && block_.size() < size_; code = next()) {
      if (code == kClear) {
        clear();
        previous = kEnd;
        continue;
      }
      if (code > strings_.size() || (code == strings_.size() && previous == kEnd)) break;
      append(code, previous != kEnd);
      previous = code;
    }
    return std::move(block_);
  }

 private:
  /// A string that stands in the block already.
  struct String {
    std::size_t begin, size;
  };

  void clear() {
    constexpr std::size_t kFirst = 258;
    strings_.resize(kFirst, {0, 1});
    bits_ = 9;
  }

  /// The string of a code; a new one is the string before with its first byte.
  void append(std::uint32_t code, bool follows) {
    const std::size_t begin = block_.size();
    if (code < 256) {
      block_.push_back(static_cast<std::uint8_t>(code));
    } else {
      const String from = code < strings_.size() ? strings_[code] : String{last_begin_, last_size_ + 1};
      for (std::size_t i = 0; i < from.size; ++i) block_.push_back(block_[from.begin + i]);
    }
    if (follows && strings_.size() < 4096) strings_.push_back({last_begin_, last_size_ + 1});
    last_begin_ = begin;
    last_size_ = block_.size() - begin;
    if (strings_.size() + 1 >= (std::size_t{1} << bits_) && bits_ < 12) ++bits_;
  }

  std::uint32_t next() {
    constexpr std::uint32_t kEnd = 257;
    std::uint32_t code = 0;
    if (at_ + bits_ > packed_.size() * 8) return kEnd;
    for (std::size_t i = 0; i < bits_; ++i, ++at_) code = code << 1 | ((packed_[at_ / 8] >> (7 - at_ % 8)) & 1U);
    return code;
  }

  Bytes packed_;
  std::size_t size_, at_ = 0, bits_ = 9, last_begin_ = 0, last_size_ = 0;
  std::vector<String> strings_;
  Block block_;
};

Block unpack(Bytes packed, std::uint32_t compression, std::size_t size) {
  switch (compression) {
    case 1:
      return {packed.begin(), packed.end()};
    case 5:
      return LzwReader(packed, size).read();
    case 8:
    case 32946:
      return inflate_at_most(packed, size);
    case 32773:
      return unpack_bits(packed, size);
    default:
      throw TiffError("is compressed in a way that is not read (code " + std::to_string(compression) +
                      "): save it uncompressed, with LZW or deflate");
  }
}

/// A piece of the image: a strip or a tile.
struct Piece {
  std::size_t width, rows, bytes_per_value;
};

void swap_values(Block& block, std::size_t size) {
  for (std::size_t at = 0; at + size <= block.size(); at += size)
    std::reverse(block.begin() + static_cast<std::ptrdiff_t>(at),
                 block.begin() + static_cast<std::ptrdiff_t>(at + size));
}

/// Differences of 16-bit values in a row become values.
void undo_differences(Block& block, const Piece& piece) {
  for (std::size_t row = 0; row < piece.rows; ++row) {
    std::uint16_t value = 0;
    for (std::size_t i = 0; i < piece.width; ++i) {
      std::uint8_t* const at = block.data() + (row * piece.width + i) * 2;
      value = static_cast<std::uint16_t>(value + (at[0] | at[1] << 8));
      std::memcpy(at, &value, 2);
    }
  }
}

/// Predictor 3: the bytes of a row's floats by their weight, highest first, as differences.
void undo_float_differences(Block& block, const Piece& piece) {
  const std::size_t row_bytes = piece.width * 4;
  for (std::size_t row = 0; row < piece.rows; ++row) {
    std::uint8_t* const bytes = block.data() + row * row_bytes;
    for (std::size_t i = 1; i < row_bytes; ++i) bytes[i] = static_cast<std::uint8_t>(bytes[i] + bytes[i - 1]);
    const Block planes(bytes, bytes + row_bytes);
    for (std::size_t i = 0; i < piece.width; ++i)
      for (std::size_t k = 0; k < 4; ++k) bytes[i * 4 + k] = planes[(3 - k) * piece.width + i];
  }
}

class TiffReader {
 public:
  explicit TiffReader(Bytes bytes) : file_(bytes), unread_(bytes.size()) {}

  cv::Mat read() {
    const std::uint32_t width = value_of(Tag::kWidth, 0), height = value_of(Tag::kHeight, 0);
    if (!is_raster_size(width, height)) throw TiffError("has a damaged header or too many pixels");
    image_.create(static_cast<int>(height), static_cast<int>(width), type());
    compression_ = value_of(Tag::kCompression, 1);
    predictor_ = value_of(Tag::kPredictor, 1);
    tiled_ = !values_of(file_, Tag::kTileOffsets).empty();
    tiled_ ? read_pieces(value_of(Tag::kTileWidth, 0), value_of(Tag::kTileHeight, 0))
           : read_pieces(width, std::min(value_of(Tag::kRowsPerStrip, height), height));
    return image_;
  }

 private:
  std::uint32_t value_of(Tag tag, std::uint32_t otherwise) const {
    const std::vector<std::uint32_t> values = values_of(file_, tag);
    return values.empty() ? otherwise : values.front();
  }

  int type() const {
    constexpr std::uint32_t kFloat = 3;
    const std::uint32_t bits = value_of(Tag::kBits, 1), samples = value_of(Tag::kSamples, 1);
    const bool floats = value_of(Tag::kFormat, 1) == kFloat;
    if (samples == 1 && bits == 16 && !floats) return CV_16UC1;
    if (samples == 1 && bits == 32 && floats) return CV_32FC1;
    throw TiffError("has " + std::to_string(samples) + " values of " + std::to_string(bits) +
                    " bits per pixel; needed is one of 16 bits, or a float of 32");
  }

  /// Row by row. Only the last of a row or a column reaches beyond the image, and not by more than another image.
  void read_pieces(std::uint32_t columns, std::uint32_t rows) {
    const std::vector<std::uint32_t> offsets = values_of(file_, tiled_ ? Tag::kTileOffsets : Tag::kStripOffsets),
                                     sizes = values_of(file_, tiled_ ? Tag::kTileBytes : Tag::kStripBytes);
    const auto width = static_cast<std::uint32_t>(image_.cols), height = static_cast<std::uint32_t>(image_.rows);
    if (!is_raster_size(columns, rows)) throw TiffError("has a damaged header");
    const std::uint64_t across = (width - 1) / columns + 1, down = (height - 1) / rows + 1;
    if (!is_raster_size(static_cast<std::int64_t>(across * columns), static_cast<std::int64_t>(down * rows), 2))
      throw TiffError("has tiles that are too large for its size");
    if (std::min(offsets.size(), sizes.size()) < across * down) throw TiffError("is truncated");
    std::size_t index = 0;
    for (std::uint32_t row = 0; row < height; row += rows) {
      for (std::uint32_t column = 0; column < width; column += columns, ++index) {
        const std::uint32_t in_piece = tiled_ ? rows : std::min(rows, height - row);
        paste(file_.piece(offsets[index], sizes[index]), {columns, in_piece, image_.elemSize1()}, row, column);
      }
    }
  }

  void paste(Bytes packed, const Piece& piece, std::uint32_t row, std::uint32_t column) {
    if (packed.size() > unread_) throw TiffError("has strips or tiles that overlap");
    unread_ -= packed.size();
    const std::size_t row_bytes = piece.width * piece.bytes_per_value;
    Block block = unpack(packed, compression_, piece.rows * row_bytes);
    if (block.size() < piece.rows * row_bytes) throw TiffError("is truncated or damaged");
    if (file_.big_endian() && predictor_ != 3) swap_values(block, piece.bytes_per_value);
    if (predictor_ == 2 && image_.type() == CV_16UC1) undo_differences(block, piece);
    if (predictor_ == 3 && image_.type() == CV_32FC1) undo_float_differences(block, piece);
    const std::size_t seen =
        std::min(piece.width, static_cast<std::size_t>(image_.cols) - column) * piece.bytes_per_value;
    for (std::size_t k = 0; k < piece.rows && row + k < static_cast<std::size_t>(image_.rows); ++k)
      std::memcpy(image_.ptr(static_cast<int>(row + k)) + column * piece.bytes_per_value, block.data() + k * row_bytes,
                  seen);
  }

  TiffBytes file_;
  std::size_t unread_;  ///< bytes that no piece has had: pieces do not overlap
  std::uint32_t compression_ = 1, predictor_ = 1;
  bool tiled_ = false;
  cv::Mat image_;
};

}  // namespace

vision::DecodedImage decode_tiff(Bytes bytes) {
  if (bytes.size() < 8) return {{}, "is truncated"};
  try {
    return {TiffReader(bytes).read(), {}};
  } catch (const TiffError& error) {
    return {{}, error.what()};
  }
}

}  // namespace rtd::camera
