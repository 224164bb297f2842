// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/device_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string_view>
#include <tuple>

#include "common/msg/rgbd_frame.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {
namespace {

constexpr int kCopy = -1, kCompressed = -2;

struct Format {
  std::string_view name;
  Stream stream;
  int type;        ///< OpenCV's, of the bytes
  int conversion;  ///< OpenCV's to BGR, or kCopy, kCompressed
};

/// In the order of preference.
constexpr std::array kFormats = {Format{"RGB8", Stream::kColor, CV_8UC3, cv::COLOR_RGB2BGR},
                                 Format{"BGR8", Stream::kColor, CV_8UC3, kCopy},
                                 Format{"YUYV", Stream::kColor, CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
                                 Format{"UYVY", Stream::kColor, CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
                                 Format{"MJPG", Stream::kColor, CV_8UC3, kCompressed},
                                 Format{"GREY", Stream::kColor, CV_8UC1, cv::COLOR_GRAY2BGR},
                                 Format{"Z16", Stream::kDepth, CV_16UC1, kCopy}};

const Format* find(const std::string& name) {
  const auto* const found = std::ranges::find(kFormats, name, &Format::name);
  return found == kFormats.end() ? nullptr : &*found;
}

ImageRead refuse(Stream stream, const std::string& name, const std::string& cause) {
  const SkipReason reason = stream == Stream::kColor ? SkipReason::kColorUnreadable : SkipReason::kDepthUnreadable;
  return {{}, SkippedInput{reason, name + ": " + cause}};
}

}  // namespace

bool readable(const std::string& format, Stream stream) {
  const Format* const known = find(format);
  return known != nullptr && known->stream == stream;
}

std::string readable_formats(Stream stream) {
  std::string text;
  for (const Format& format : kFormats) {
    if (format.stream == stream) text += fmt::format("{}{}", text.empty() ? "" : ", ", format.name);
  }
  return text;
}

int preference(const std::string& format) {
  const Format* const known = find(format);
  return known == nullptr ? static_cast<int>(kFormats.size()) : static_cast<int>(known - kFormats.data());
}

std::string wrong_size(const DeviceMode& mode, std::size_t bytes) {
  const Format* const format = find(mode.format);
  if (format == nullptr) return "format " + mode.format + " is not known";
  if (format->conversion == kCompressed) return bytes == 0 ? "it is empty" : "";
  const std::size_t needed =
      static_cast<std::size_t>(mode.size_px.area()) * static_cast<std::size_t>(CV_ELEM_SIZE(format->type));
  if (bytes == needed) return {};
  return fmt::format("{} bytes are not {} x {} px of {} ({} bytes)", bytes, mode.size_px.width, mode.size_px.height,
                     mode.format, needed);
}

ImageRead decode_image(const DeviceMode& mode, const std::vector<std::uint8_t>& bytes, const std::string& name) {
  if (const std::string cause = wrong_size(mode, bytes.size()); !cause.empty()) return refuse(mode.stream, name, cause);
  const Format& format = *find(mode.format);
  if (format.conversion == kCompressed) return decode_color(bytes, name);
  const cv::Mat pixels(mode.size_px, format.type, const_cast<std::uint8_t*>(bytes.data()));  // only read
  ImageRead result;
  if (format.conversion == kCopy) {
    pixels.copyTo(result.image);
  } else {
    cv::cvtColor(pixels, result.image, format.conversion);
  }
  if (mode.stream == Stream::kDepth) drop_saturated(result.image);
  return result;
}

namespace {

constexpr int kUsualWidth = 640, kUsualHeight = 480;
constexpr double kUsualFps = 30;

bool fits_frame(cv::Size size_px) {
  return size_px.width > 0 && size_px.height > 0 &&
         msg::fits(static_cast<std::uint64_t>(size_px.width), static_cast<std::uint64_t>(size_px.height),
                   msg::kMaxFramePixels);
}

bool fits(const DeviceMode& mode, const ModeRequest& request) {
  return (request.width == 0 || mode.size_px.width == request.width) &&
         (request.height == 0 || mode.size_px.height == request.height) &&
         (request.fps == 0 || std::abs(mode.fps - request.fps) < 0.5);
}

/// Smaller is better.
auto rank(const DeviceMode& mode) {
  const bool usual = mode.size_px == cv::Size(kUsualWidth, kUsualHeight);
  return std::tuple(usual ? 0 : 1, -mode.size_px.area(), std::abs(mode.fps - kUsualFps), preference(mode.format));
}

std::string request_text(const ModeRequest& request) {
  std::string text;
  if (request.width > 0 || request.height > 0) {
    const auto side = [](int px) { return px > 0 ? std::to_string(px) : std::string("any"); };
    text += " of " + side(request.width) + " x " + side(request.height) + " px";
  }
  if (request.fps > 0) text += fmt::format(" at {:g} Hz", request.fps);
  return text;
}

}  // namespace

const char* to_string(Stream stream) {
  return stream == Stream::kColor ? "colour" : "depth";
}

std::string list_modes(const std::vector<DeviceMode>& modes, Stream stream) {
  std::map<std::tuple<int, int, std::string>, std::set<int>> rates;
  for (const DeviceMode& mode : modes) {
    if (mode.stream != stream) continue;
    rates[{mode.size_px.width, mode.size_px.height, mode.format}].insert(static_cast<int>(std::lround(mode.fps)));
  }
  std::string text;
  for (const auto& [mode, values] : rates) {
    const auto& [width, height, format] = mode;
    text += fmt::format("{}{} x {} {} ", text.empty() ? "" : "; ", width, height, format);
    for (const int fps : values) text += fmt::format("{}{}", fps == *values.begin() ? "" : ", ", fps);
    text += " Hz";
  }
  return text.empty() ? "none" : text;
}

DeviceMode choose_mode(const std::vector<DeviceMode>& modes, Stream stream, const ModeRequest& request,
                       const std::string& device) {
  std::optional<DeviceMode> best;
  for (const DeviceMode& mode : modes) {
    if (mode.stream != stream || !readable(mode.format, stream) || !fits_frame(mode.size_px) || !fits(mode, request))
      continue;
    if (!best || rank(mode) < rank(*best)) best = mode;
  }
  if (best) return *best;
  throw DeviceError(
      DeviceProblem::kUnsupportedMode,
      fmt::format("{} has no {} mode{} that can be used (readable: {}; at most 1920 x 1200 px); it has: {}. "
                  "Choose one with ?width=&height=&fps=",
                  device, to_string(stream), request_text(request), readable_formats(stream),
                  list_modes(modes, stream)));
}

}  // namespace rtd::camera
