// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/image_decoders.hpp"

#include <jerror.h>   // after jpeglib.h
#include <jpeglib.h>  // after <cstdio>
#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>  // jpeglib.h uses FILE
#include <cstdlib>
#include <optional>

//
// libjpeg reports errors by longjmp, which passes over destructors. So everything between setjmp and longjmp belongs to
// objects that are made before.
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

/// 1 to 8 of the EXIF data (the tag "Orientation" of TIFF 6.0), or 1 where there are none. `app1`: the contents of a
/// JPEG's marker APP1: a TIFF header (order, 42, offset of the first directory), then entries of 12 bytes: tag, type,
/// count, value.
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

/// The image as it is meant to be looked at.
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

constexpr int kMaxScans = 64;                     // progressive JPEGs of cameras and programs have about ten
constexpr std::int64_t kMaxPixelsPerByte = 1024;  // the emptiest grey image has 512: one bit for 8 x 8 px
constexpr long kMaxWarnings = 64;                 // damaged data; a few are padding and unknown markers
constexpr std::int64_t kMaxJpegSide = 32768;

/// What libjpeg calls on errors and warnings. `manager` comes first: libjpeg knows only that part.
struct JpegErrors {
  jpeg_error_mgr manager{};
  std::jmp_buf target{};
  std::array<char, JMSG_LENGTH_MAX> text{};

  JpegErrors() {
    jpeg_std_error(&manager);
    manager.error_exit = [](j_common_ptr info) { of(info).leave(info); };
    manager.emit_message = [](j_common_ptr info, int level) { of(info).note(info, level); };
    manager.output_message = [](j_common_ptr) {};
  }

 private:
  static JpegErrors& of(j_common_ptr info) { return *reinterpret_cast<JpegErrors*>(info->err); }
  [[noreturn]] void leave(j_common_ptr info) {
    manager.format_message(info, text.data());
    std::longjmp(target, 1);
  }
  void note(j_common_ptr info, int level) {
    if (level >= 0) return;  // a trace
    ++manager.num_warnings;
    if (manager.msg_code == JWRN_JPEG_EOF || manager.num_warnings > kMaxWarnings) leave(info);
  }
};

/// Watches the scans: each goes over all of the image, and a file of a few kB can have thousands.
struct ScanGuard {
  jpeg_progress_mgr manager{};
  ScanGuard() {
    manager.progress_monitor = [](j_common_ptr info) {
      auto* const decoder = reinterpret_cast<j_decompress_ptr>(info);
      if (decoder->input_scan_number > kMaxScans) ERREXIT(info, JERR_BAD_PROGRESSION);
    };
  }
};

class JpegDecoder {
 public:
  JpegDecoder(std::span<const std::uint8_t> bytes, const DecodeRules& rules) : bytes_(bytes), rules_(rules) {
    info_.err = &errors_.manager;
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&info_); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  DecodedImage decode() {
    if (!read_header()) return {{}, broken()};
    if (std::string problem = refusal(); !problem.empty()) return {{}, std::move(problem)};
    DecodedImage result;
    const bool grey = rules_.pixels == PixelsAs::kGrey || (rules_.pixels == PixelsAs::kStored && is_grey());
    result.pixels.create(static_cast<int>(info_.image_height), static_cast<int>(info_.image_width),
                         grey ? CV_8UC1 : CV_8UC3);
    const int turned = rules_.upright ? orientation() : 1;  // libjpeg forgets the markers with the last row
    info_.out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
    if (!read_pixels(result.pixels.data, result.pixels.step)) return {{}, broken()};
    result.pixels = turn_upright(result.pixels, turned);
    return result;
  }

 private:
  bool read_header() {
    if (setjmp(errors_.target) != 0) return false;
    jpeg_create_decompress(&info_);
    info_.progress = &scans_.manager;
    constexpr unsigned kLongestMarker = 0xFFFF;
    if (rules_.upright) jpeg_save_markers(&info_, JPEG_APP0 + 1, kLongestMarker);
    jpeg_mem_src(&info_, bytes_.data(), bytes_.size());
    return jpeg_read_header(&info_, TRUE) == JPEG_HEADER_OK;
  }

  bool read_pixels(std::uint8_t* row, std::size_t step) {
    if (setjmp(errors_.target) != 0) return false;
    jpeg_start_decompress(&info_);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW at = row + info_.output_scanline * step;
      jpeg_read_scanlines(&info_, &at, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  std::string refusal() const {
    const std::int64_t width = info_.image_width, height = info_.image_height, pixels = width * height;
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " px";
    if (width > kMaxJpegSide || height > kMaxJpegSide || pixels > rules_.max_pixels)
      return "has " + size + ", the most that is read is " + std::to_string(rules_.max_pixels) + " px";
    if (pixels / kMaxPixelsPerByte > static_cast<std::int64_t>(bytes_.size()))
      return "claims " + size + ", which its " + std::to_string(bytes_.size()) + " bytes cannot hold";
    if (info_.num_components != 1 && info_.num_components != 3)
      return "is a JPEG with " + std::to_string(info_.num_components) + " colour components; save it as RGB or grey";
    return {};
  }

  bool is_grey() const { return info_.num_components == 1; }
  std::string broken() const { return std::string("cannot be decoded as an image: ") + errors_.text.data(); }

  int orientation() const {
    for (const jpeg_marker_struct* marker = info_.marker_list; marker != nullptr; marker = marker->next)
      if (const int found = exif_orientation({marker->data, marker->data_length}); found != 1) return found;
    return 1;
  }

  std::span<const std::uint8_t> bytes_;
  const DecodeRules& rules_;
  JpegErrors errors_;
  ScanGuard scans_;
  jpeg_decompress_struct info_{};
};

class JpegEncoder {
 public:
  JpegEncoder() { info_.err = &errors_.manager; }
  ~JpegEncoder() {
    jpeg_destroy_compress(&info_);
    std::free(buffer_);
  }
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  std::vector<std::uint8_t> encode(const cv::Mat& image, int quality) {
    if (!write(image, quality)) return {};
    return {buffer_, buffer_ + size_};
  }

 private:
  bool write(const cv::Mat& image, int quality) {
    if (setjmp(errors_.target) != 0) return false;
    jpeg_create_compress(&info_);
    jpeg_mem_dest(&info_, &buffer_, &size_);
    info_.image_width = static_cast<JDIMENSION>(image.cols);
    info_.image_height = static_cast<JDIMENSION>(image.rows);
    info_.input_components = image.channels();
    info_.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
    jpeg_set_defaults(&info_);
    jpeg_set_quality(&info_, quality, TRUE);
    jpeg_start_compress(&info_, TRUE);
    while (info_.next_scanline < info_.image_height) {
      JSAMPROW row = const_cast<JSAMPROW>(image.data + info_.next_scanline * image.step);
      jpeg_write_scanlines(&info_, &row, 1);
    }
    jpeg_finish_compress(&info_);
    return true;
  }

  JpegErrors errors_;
  jpeg_compress_struct info_{};
  unsigned char* buffer_ = nullptr;
  unsigned long size_ = 0;
};

}  // namespace

DecodedImage decode_jpeg(std::span<const std::uint8_t> bytes, const DecodeRules& rules) {
  return JpegDecoder(bytes, rules).decode();
}

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality) {
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_8UC3)) return {};
  return JpegEncoder().encode(image, quality);
}

}  // namespace rtd::vision
