// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/image_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "common/camera/folder/depth_formats.hpp"
#include "common/vision/image_codecs.hpp"

namespace rtd::camera {
namespace {

using Bytes = std::span<const std::uint8_t>;

std::optional<std::vector<std::uint8_t>> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return std::nullopt;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::max<std::streamoff>(stream.tellg(), 0)));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream && !bytes.empty()) return std::nullopt;
  return bytes;
}

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
  if (bytes.empty()) return refuse(unreadable, name, "is empty");
  if (!complete(bytes)) return refuse(unreadable, name, "is truncated");
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
  ImageRead result = decode(encoded, name, vision::PixelsAs::kStored, SkipReason::kDepthUnreadable);
  if (result.problem) return result;
  if (result.image.type() != CV_16UC1) {
    return refuse(
        SkipReason::kDepthNot16Bit, name,
        "depth is " + pixel_type_name(result.image) + ", needed is a 16-bit, 1-channel PNG (0 = no measurement)");
  }
  drop_saturated(result.image);
  return result;
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

ImageRead read_color(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  if (!bytes) return refuse(SkipReason::kColorUnreadable, file.string(), "cannot be read");
  if (!to_view(*bytes).starts_with("P6")) return decode_color(*bytes, file.string());
  vision::DecodedImage decoded = decode_color_values(*bytes);
  if (!decoded.problem.empty()) return refuse(SkipReason::kColorUnreadable, file.string(), decoded.problem);
  return {std::move(decoded.pixels), {}};
}

ImageRead read_depth(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  if (!bytes) return refuse(SkipReason::kDepthUnreadable, file.string(), "cannot be read");
  const bool known = vision::format_of(*bytes) != vision::ImageFormat::kUnknown;
  if (bytes->empty() || known) return decode_depth(*bytes, file.string());
  vision::DecodedImage decoded = decode_depth_values(*bytes);
  if (!decoded.problem.empty()) return refuse(SkipReason::kDepthUnreadable, file.string(), decoded.problem);
  if (decoded.pixels.type() == CV_16UC1) drop_saturated(decoded.pixels);
  return {std::move(decoded.pixels), {}};
}

}  // namespace rtd::camera
