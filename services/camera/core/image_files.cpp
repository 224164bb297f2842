// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/image_files.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

namespace rtd::camera {
namespace {

using Bytes = std::vector<char>;

std::optional<Bytes> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return std::nullopt;
  Bytes bytes(static_cast<std::size_t>(std::max<std::streamoff>(stream.tellg(), 0)));
  stream.seekg(0);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream && !bytes.empty()) return std::nullopt;
  return bytes;
}

bool starts_with(const Bytes& bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

/// The end mark of PNG (IEND chunk) or JPEG (EOI) stands near the end of the file; other formats are left to the
/// decoder.
bool complete(const Bytes& bytes) {
  constexpr std::size_t kTrailer = 256;  // some writers pad
  const std::string_view tail(bytes.data() + bytes.size() - std::min(kTrailer, bytes.size()),
                              std::min(kTrailer, bytes.size()));
  if (starts_with(bytes, "\x89PNG")) return tail.find("IEND\xAE\x42\x60\x82") != std::string_view::npos;
  if (starts_with(bytes, "\xFF\xD8")) return tail.rfind("\xFF\xD9") != std::string_view::npos;
  return true;
}

ImageRead refuse(SkipReason reason, const std::filesystem::path& file, const std::string& cause) {
  return {{}, SkippedInput{reason, file.string() + ": " + cause}};
}

ImageRead decode(const std::filesystem::path& file, int flags, SkipReason unreadable) {
  std::optional<Bytes> bytes = read_bytes(file);
  if (!bytes) return refuse(unreadable, file, "cannot be read");
  if (bytes->empty()) return refuse(unreadable, file, "is empty");
  if (!complete(*bytes)) return refuse(unreadable, file, "is truncated");
  ImageRead result;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes->size()), CV_8UC1, bytes->data());
    result.image = cv::imdecode(encoded, flags);
  } catch (const cv::Exception&) {
    result.image.release();
  }
  if (result.image.empty()) return refuse(unreadable, file, "is no image that can be decoded");
  return result;
}

std::string pixel_type_name(const cv::Mat& image) {
  static constexpr std::array<const char*, 8> kDepths = {"8-bit",  "8-bit signed", "16-bit",       "16-bit signed",
                                                         "32-bit", "32-bit float", "64-bit float", "16-bit float"};
  return std::string(kDepths.at(static_cast<std::size_t>(image.depth()))) + ", " + std::to_string(image.channels()) +
         (image.channels() == 1 ? " channel" : " channels");
}

void drop_saturated(cv::Mat& depth) {
  for (int row = 0; row < depth.rows; ++row) {
    auto* pixels = depth.ptr<std::uint16_t>(row);
    std::replace(pixels, pixels + depth.cols, std::uint16_t{65535}, std::uint16_t{0});
  }
}

}  // namespace

ImageRead read_color(const std::filesystem::path& file) {
  return decode(file, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION, SkipReason::kColorUnreadable);
}

ImageRead read_depth(const std::filesystem::path& file) {
  ImageRead result = decode(file, cv::IMREAD_UNCHANGED, SkipReason::kDepthUnreadable);
  if (result.problem) return result;
  if (result.image.type() != CV_16UC1) {
    return refuse(
        SkipReason::kDepthNot16Bit, file,
        "depth is " + pixel_type_name(result.image) + ", needed is a 16-bit, 1-channel PNG (0 = no measurement)");
  }
  drop_saturated(result.image);
  return result;
}

}  // namespace rtd::camera
