// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// libjpeg reports errors by longjmp, which passes over destructors. So everything between setjmp and longjmp belongs to
// objects that are made before.
#include "common/vision/jpeg_codec.hpp"

#include <array>
#include <csetjmp>
#include <cstdio>  // jpeglib.h uses FILE
#include <cstdlib>

#include <jpeglib.h>  // after <cstdio>

#include <jerror.h>  // after jpeglib.h

namespace rtd::vision {
namespace {

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
