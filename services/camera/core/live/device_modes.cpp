// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/device_modes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "common/msg/rgbd_frame.hpp"
#include "services/camera/core/live/live_device.hpp"
#include "services/camera/core/live/pixel_format.hpp"

namespace rtd::camera {
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
