// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// libpng reports errors by longjmp, which passes over destructors. So everything between setjmp and longjmp belongs to
// objects that are made before.
#include "common/vision/image_decoders.hpp"

#include <png.h>

#include <array>
#include <csetjmp>
#include <cstring>
#include <new>
#include <optional>
#include <utility>

namespace rtd::vision {
namespace {

constexpr png_uint_32 kMaxPngSide = 32768;
constexpr png_alloc_size_t kMaxChunkBytes = 1 << 20;  // of colour profiles, which are not needed here
constexpr std::array<png_byte, 15> kTexts = {'t', 'E', 'X', 't', 0,   'z', 'T', 'X',
                                             't', 0,   'i', 'T', 'X', 't', 0};  // unread
constexpr double kRedOfGrey = 0.299, kGreenOfGrey = 0.587;

struct PngErrors {
  std::array<char, 128> text{};
  [[noreturn]] static void leave(png_structp png, png_const_charp message) {
    auto& errors = *static_cast<PngErrors*>(png_get_error_ptr(png));
    std::strncpy(errors.text.data(), message, errors.text.size() - 1);
    png_longjmp(png, 1);
  }
  static void pass(png_structp, png_const_charp) {}
};

class PngDecoder {
 public:
  PngDecoder(std::span<const std::uint8_t> bytes, const DecodeRules& rules)
      : left_(bytes),
        bytes_(bytes.size()),
        rules_(rules),
        png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &errors_, PngErrors::leave, PngErrors::pass)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {}
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  DecodedImage decode() {
    if (info_ == nullptr) throw std::bad_alloc();
    if (!read_header()) return {{}, broken()};
    if (std::string problem = refusal(); !problem.empty()) return {{}, std::move(problem)};
    DecodedImage result;
    result.pixels.create(static_cast<int>(height_), static_cast<int>(width_), pixel_type());
    std::vector<png_bytep> rows;
    for (int row = 0; row < result.pixels.rows; ++row) rows.push_back(result.pixels.ptr(row));
    if (!read_pixels(result.pixels.type(), result.pixels.cols * result.pixels.elemSize(), rows.data()))
      return {{}, broken()};
    return result;
  }

 private:
  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, kMaxPngSide, kMaxPngSide);
    png_set_chunk_malloc_max(png_, kMaxChunkBytes);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, kTexts.data(), kTexts.size() / 5);
    png_set_read_fn(png_, this, [](png_structp png, png_bytep to, png_size_t count) {
      static_cast<PngDecoder*>(png_get_io_ptr(png))->give(to, count);
    });
    png_read_info(png_, info_);
    png_get_IHDR(png_, info_, &width_, &height_, &bits_, &color_, nullptr, nullptr, nullptr);
    return true;
  }

  void give(png_bytep to, png_size_t count) {
    if (count > left_.size()) png_error(png_, "it is truncated");
    std::memcpy(to, left_.data(), count);
    left_ = left_.subspan(count);
  }

  /// What is asked for, or by what the file has: transparent grey is BGRA.
  int pixel_type() const {
    if (rules_.pixels == PixelsAs::kBgr) return CV_8UC3;
    if (rules_.pixels == PixelsAs::kGrey) return CV_8UC1;
    const bool has_color = (color_ & PNG_COLOR_MASK_COLOR) != 0;
    const bool transparent =
        (color_ & PNG_COLOR_MASK_ALPHA) != 0 || (has_color && png_get_valid(png_, info_, PNG_INFO_tRNS) != 0);
    return CV_MAKETYPE(bits_ == 16 ? CV_16U : CV_8U, transparent ? 4 : (has_color ? 3 : 1));
  }

  bool read_pixels(int type, std::size_t row_bytes, png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    convert_to(type);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != row_bytes) png_error(png_, "its rows have an unexpected size");
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  void convert_to(int type) {
    const bool has_color = (color_ & PNG_COLOR_MASK_COLOR) != 0, wants_color = CV_MAT_CN(type) > 1;
    CV_MAT_DEPTH(type) == CV_8U&& bits_ == 16 ? png_set_strip_16(png_) : png_set_swap(png_);
    CV_MAT_CN(type) < 4 ? png_set_strip_alpha(png_) : png_set_tRNS_to_alpha(png_);
    if (color_ == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png_);
    if (!has_color && bits_ < 8) png_set_expand_gray_1_2_4_to_8(png_);
    if (has_color && wants_color) {
      png_set_bgr(png_);
    } else if (wants_color) {
      png_set_gray_to_rgb(png_);
    } else if (has_color) {
      png_set_rgb_to_gray(png_, PNG_ERROR_ACTION_NONE, kRedOfGrey, kGreenOfGrey);
    }
  }

  std::string refusal() const {
    const std::int64_t pixels = std::int64_t{width_} * height_;
    const std::string size = std::to_string(width_) + " x " + std::to_string(height_) + " px";
    if (pixels > rules_.max_pixels)
      return "has " + size + ", the most that is read is " + std::to_string(rules_.max_pixels) + " px";
    const std::int64_t stored_bytes = pixels * bits_ * png_get_channels(png_, info_) / 8;
    if (stored_bytes / kMaxBytesPerByte > static_cast<std::int64_t>(bytes_))
      return "claims " + size + ", which its " + std::to_string(bytes_) + " bytes cannot hold";
    return {};
  }

  std::string broken() const { return std::string("cannot be decoded as an image: ") + errors_.text.data(); }

  std::span<const std::uint8_t> left_;
  std::size_t bytes_;
  const DecodeRules& rules_;
  PngErrors errors_;
  png_structp png_;
  png_infop info_;
  png_uint_32 width_ = 0, height_ = 0;
  int bits_ = 0, color_ = 0;
};

class PngEncoder {
 public:
  PngEncoder()
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &errors_, PngErrors::leave, PngErrors::pass)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {}
  ~PngEncoder() { png_destroy_write_struct(&png_, &info_); }
  PngEncoder(const PngEncoder&) = delete;
  PngEncoder& operator=(const PngEncoder&) = delete;

  std::vector<std::uint8_t> encode(const cv::Mat& image) {
    if (info_ == nullptr) throw std::bad_alloc();
    std::vector<png_bytep> rows;
    for (int row = 0; row < image.rows; ++row) rows.push_back(const_cast<png_bytep>(image.ptr(row)));
    if (!write(image, rows.data())) bytes_.clear();
    return std::move(bytes_);
  }

 private:
  bool write(const cv::Mat& image, png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(
        png_, &bytes_,
        [](png_structp png, png_bytep from, png_size_t count) {
          auto& bytes = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
          bytes.insert(bytes.end(), from, from + count);
        },
        nullptr);
    const int color = image.channels() == 1   ? PNG_COLOR_TYPE_GRAY
                      : image.channels() == 3 ? PNG_COLOR_TYPE_RGB
                                              : PNG_COLOR_TYPE_RGB_ALPHA;
    constexpr int kFast = 1;
    png_set_compression_level(png_, kFast);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
                 image.depth() == CV_8U ? 8 : 16, color, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png_, info_);
    png_set_bgr(png_);
    png_set_swap(png_);
    png_write_image(png_, rows);
    png_write_end(png_, info_);
    return true;
  }

  PngErrors errors_;
  std::vector<std::uint8_t> bytes_;
  png_structp png_;
  png_infop info_;
};

bool can_be_png(const cv::Mat& image) {
  const int channels = image.channels();
  return !image.empty() && (image.depth() == CV_8U || image.depth() == CV_16U) &&
         (channels == 1 || channels == 3 || channels == 4);
}

}  // namespace

DecodedImage decode_png(std::span<const std::uint8_t> bytes, const DecodeRules& rules) {
  if (std::optional<cv::Mat> pixels = decode_plain_png(bytes, rules)) return {std::move(*pixels), {}};
  return PngDecoder(bytes, rules).decode();
}

std::vector<std::uint8_t> encode_png(const cv::Mat& image) {
  return can_be_png(image) ? PngEncoder().encode(image) : std::vector<std::uint8_t>{};
}

}  // namespace rtd::vision
