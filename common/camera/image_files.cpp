// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/image_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "common/camera/depth_figures.hpp"
#include "common/camera/depth_formats.hpp"
#include "common/io/input_file.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;

std::string_view to_view(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The end mark of PNG (IEND chunk) or JPEG (EOI) is near the end of the file; other formats are left to the
/// decoder.
bool complete(Bytes bytes) {
  constexpr std::size_t kTrailer = 256;  // some writers pad
  const std::string_view tail = to_view(bytes.last(std::min(kTrailer, bytes.size())));
  if (to_view(bytes).starts_with("\x89PNG")) return tail.find("IEND\xAE\x42\x60\x82") != std::string_view::npos;
  if (to_view(bytes).starts_with("\xFF\xD8")) return tail.rfind("\xFF\xD9") != std::string_view::npos;
  return true;
}

ImageRead refuse(SkipReason reason, const std::string& name, const std::string& cause) {
  return {{}, SkippedInput{reason, name + ": " + cause}};
}

ImageRead decode(Bytes bytes, const std::string& name, vision::PixelsAs pixels, SkipReason unreadable) {
  if (bytes.empty()) return refuse(unreadable, name, "is empty: copy the file again");
  if (!complete(bytes)) return refuse(unreadable, name, "is truncated: copy the file again");
  vision::DecodedImage decoded =
      vision::decode_image(bytes, {.pixels = pixels, .max_pixels = vision::DecodeRules::kMaxStreamPixels});
  if (!decoded.problem.empty()) return refuse(unreadable, name, decoded.problem);
  return {std::move(decoded.pixels), {}};
}

std::string pixel_type_name(const cv::Mat& image) {
  static constexpr std::array<const char*, 8> kDepths = {"8-bit",  "8-bit signed", "16-bit",       "16-bit signed",
                                                         "32-bit", "32-bit float", "64-bit float", "16-bit float"};
  return std::string(kDepths.at(static_cast<std::size_t>(image.depth()))) + ", " + std::to_string(image.channels()) +
         (image.channels() == 1 ? " channel" : " channels");
}

/// The image in the content of a file.
ImageRead color_in(Bytes content, const std::string& name) {
  if (!to_view(content).starts_with("P6")) return decode_color(content, name);
  vision::DecodedImage decoded = decode_color_values(content);
  if (!decoded.problem.empty()) return refuse(SkipReason::kColorUnreadable, name, decoded.problem);
  return {std::move(decoded.pixels), {}};
}

/// TartanAir V2 stores a float a pixel as four bytes of a PNG. Empty when they are none.
cv::Mat floats_in(const cv::Mat& pixels) {
  constexpr double kFarthest_m = 1e5;  // of the sky
  if (pixels.type() != CV_8UC4) return {};
  const cv::Mat values(pixels.size(), CV_32FC1, const_cast<std::uint8_t*>(pixels.data), pixels.step);
  const double nearest = float_quantile(values, 0.1), farthest = float_quantile(values, 0.9);
  return nearest > 1e-3 && farthest < kFarthest_m ? values.clone() : cv::Mat();
}

/// 16 bits, one channel, without saturation: what a decoded image must be, or be refused.
ImageRead as_depth(ImageRead result, const std::string& name) {
  if (result.problem) return result;
  if (result.image.type() != CV_16UC1) {
    const bool painted = result.image.depth() == CV_8U && result.image.channels() > 1;
    return refuse(SkipReason::kDepthNot16Bit, name,
                  "depth is " + pixel_type_name(result.image) +
                      ", needed is a 16-bit, 1-channel PNG (0 = no measurement)" +
                      (painted ? "; colours are for people, and distances cannot be had back from them: export the "
                                 "depth itself (of a RealSense recording: rs-convert -r, or give the recording)"
                               : ""));
  }
  drop_saturated(result.image);
  return result;
}

ImageRead depth_in(Bytes content, const std::string& name) {
  const bool known = vision::format_of(content) != vision::ImageFormat::kUnknown;
  if (content.empty() || known) {
    ImageRead stored = decode(content, name, vision::PixelsAs::kStored, SkipReason::kDepthUnreadable);
    if (cv::Mat values = floats_in(stored.image); !values.empty()) return {std::move(values), {}};
    return as_depth(std::move(stored), name);
  }
  vision::DecodedImage decoded = decode_depth_values(content);
  if (!decoded.problem.empty()) return refuse(SkipReason::kDepthUnreadable, name, decoded.problem);
  if (decoded.pixels.type() == CV_16UC1) drop_saturated(decoded.pixels);
  return {std::move(decoded.pixels), {}};
}

ImageRead read(const std::filesystem::path& file, const std::filesystem::path& below, SkipReason unreadable,
               ImageRead (*image_in)(Bytes, const std::string&)) {
  try {
    const std::string content = io::read_file(file, io::kImage, below);
    return image_in({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, file.string());
  } catch (const io::IoError& error) {
    return {{}, SkippedInput{unreadable, why_unread(error)}};
  }
}

}  // namespace

void drop_saturated(cv::Mat& depth) {
  for (int row = 0; row < depth.rows; ++row) {
    auto* pixels = depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < depth.cols; ++column)  // vector instructions, unlike std::replace
      pixels[column] = pixels[column] == 65535 ? std::uint16_t{0} : pixels[column];
  }
}

ImageRead decode_color(Bytes encoded, const std::string& name) {
  return decode(encoded, name, vision::PixelsAs::kBgr, SkipReason::kColorUnreadable);
}

ImageRead decode_depth(Bytes encoded, const std::string& name) {
  return as_depth(decode(encoded, name, vision::PixelsAs::kStored, SkipReason::kDepthUnreadable), name);
}

cv::Mat quantize_depth(const cv::Mat& values, double step) {
  constexpr double kMaxUnits = 65534;  // 65535 is TUM's "saturated"
  cv::Mat depth(values.size(), CV_16UC1);
  for (int row = 0; row < depth.rows; ++row) {
    const auto* from = values.ptr<float>(row);
    auto* to = depth.ptr<std::uint16_t>(row);
    for (int column = 0; column < depth.cols; ++column) {
      const double units = std::round(from[column] / step);
      to[column] = units >= 0 && units <= kMaxUnits ? static_cast<std::uint16_t>(units) : 0;  // NaN compares false
    }
  }
  return depth;
}

ImageRead read_color(const std::filesystem::path& file, const std::filesystem::path& below) {
  return read(file, below, SkipReason::kColorUnreadable, color_in);
}

ImageRead read_depth(const std::filesystem::path& file, const std::filesystem::path& below) {
  return read(file, below, SkipReason::kDepthUnreadable, depth_in);
}

}  // namespace rtd::camera
