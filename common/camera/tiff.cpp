// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#define TIFF_DISABLE_DEPRECATED  // its types of the names of OpenCV's
#include <tiffio.hxx>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "common/camera/depth_formats.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// What is said of the file; caught in decode_tiff().
class TiffError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class TiffReader {
 public:
  explicit TiffReader(Bytes bytes) : stream_({bytes.begin(), bytes.end()}), unread_(bytes.size()) {
    static const bool silent = TIFFSetErrorHandler(nullptr) != TIFFSetWarningHandler(nullptr);
    static_cast<void>(silent);  // libtiff would write to stderr
    file_.reset(TIFFStreamOpen("depth", &stream_));
    if (!file_) throw TiffError("is truncated or damaged");
  }

  cv::Mat read() {
    const auto width = value_of<std::uint32_t>(TIFFTAG_IMAGEWIDTH),
               height = value_of<std::uint32_t>(TIFFTAG_IMAGELENGTH);
    if (!is_raster_size(width, height)) throw TiffError("has a damaged header or too many pixels");
    require_compression();
    image_.create(static_cast<int>(height), static_cast<int>(width), type());
    TIFFIsTiled(file_.get()) != 0
        ? read_pieces(value_of<std::uint32_t>(TIFFTAG_TILEWIDTH), value_of<std::uint32_t>(TIFFTAG_TILELENGTH))
        : read_pieces(width, std::min(value_of<std::uint32_t>(TIFFTAG_ROWSPERSTRIP), height));
    return image_;
  }

 private:
  template <class Number>
  Number value_of(std::uint32_t tag) const {
    Number number = 0;
    TIFFGetFieldDefaulted(file_.get(), tag, &number);
    return number;
  }

  void require_compression() const {
    constexpr std::array<int, 5> kRead = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                          COMPRESSION_DEFLATE, COMPRESSION_PACKBITS};
    const int compression = value_of<std::uint16_t>(TIFFTAG_COMPRESSION);
    if (std::ranges::find(kRead, compression) != kRead.end()) return;
    throw TiffError("is compressed in a way that is not read (code " + std::to_string(compression) +
                    "): save it uncompressed, with LZW or deflate");
  }

  int type() const {
    const int bits = value_of<std::uint16_t>(TIFFTAG_BITSPERSAMPLE),
              samples = value_of<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL);
    const bool floats = value_of<std::uint16_t>(TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_IEEEFP;
    if (samples == 1 && bits == 16 && !floats) return CV_16UC1;
    if (samples == 1 && bits == 32 && floats) return CV_32FC1;
    throw TiffError("has " + std::to_string(samples) + " values of " + std::to_string(bits) +
                    " bits per pixel; needed is one of 16 bits, or a float of 32");
  }

  /// Strips or tiles, row by row. Only the last of a row or a column reaches beyond the image, and not by more than
  /// another image.
  void read_pieces(std::uint32_t columns, std::uint32_t rows) {
    const auto width = static_cast<std::uint32_t>(image_.cols), height = static_cast<std::uint32_t>(image_.rows);
    if (!is_raster_size(columns, rows)) throw TiffError("has a damaged header");
    const std::uint64_t across = (width - 1) / columns + 1, down = (height - 1) / rows + 1;
    if (!is_raster_size(static_cast<std::int64_t>(across * columns), static_cast<std::int64_t>(down * rows), 2))
      throw TiffError("has tiles that are too large for its size");
    const std::size_t row_bytes = columns * image_.elemSize();
    std::vector<std::uint8_t> piece(rows * row_bytes);
    std::uint32_t index = 0;
    for (std::uint32_t row = 0; row < height; row += rows) {
      for (std::uint32_t column = 0; column < width; column += columns, ++index) {
        const std::uint32_t seen = std::min(rows, height - row);
        read_piece(index, {piece.data(), (TIFFIsTiled(file_.get()) != 0 ? rows : seen) * row_bytes});
        for (std::uint32_t k = 0; k < seen; ++k)
          std::memcpy(image_.ptr(static_cast<int>(row + k)) + column * image_.elemSize(), piece.data() + k * row_bytes,
                      std::min(columns, width - column) * image_.elemSize());
      }
    }
  }

  void read_piece(std::uint32_t index, std::span<std::uint8_t> piece) {
    const std::uint64_t packed = TIFFGetStrileByteCount(file_.get(), index);
    if (packed > unread_) throw TiffError("has strips or tiles that overlap");
    unread_ -= packed;
    const auto size = static_cast<tmsize_t>(piece.size());
    const auto read = TIFFIsTiled(file_.get()) != 0 ? TIFFReadEncodedTile : TIFFReadEncodedStrip;
    if (read(file_.get(), index, piece.data(), size) != size) throw TiffError("is truncated or damaged");
  }

  struct Close {
    void operator()(TIFF* file) const { TIFFClose(file); }
  };
  std::istringstream stream_;
  std::unique_ptr<TIFF, Close> file_;
  std::uint64_t unread_;  ///< bytes that no piece has had: pieces do not overlap
  cv::Mat image_;
};

}  // namespace

vision::DecodedImage decode_tiff(Bytes bytes) {
  try {
    return {TiffReader(bytes).read(), {}};
  } catch (const TiffError& error) {
    return {{}, error.what()};
  }
}

}  // namespace rtd::camera
