// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/rgbd_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/msg/rgbd_frame.hpp"
#include "common/msg/sensor_time.hpp"

namespace rtd::vision {
namespace {

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

}  // namespace

std::string defect(const msg::RgbdFrame& frame) {
  if (!msg::is_plausible(frame)) {
    return fmt::format("size {}x{} is not within 1x1 .. {}x{}", frame.width, frame.height, msg::kMaxFrameWidth,
                       msg::kMaxFrameHeight);
  }
  const auto [fx, fy, cx, cy] = msg::aligned(frame.intrinsics);
  if (!positive(fx) || !positive(fy) || !std::isfinite(cx) || !std::isfinite(cy)) {
    return fmt::format("intrinsics fx {} fy {} cx {} cy {} are not a camera", fx, fy, cx, cy);
  }
  const bool finite =
      std::all_of(frame.distortion.begin(), frame.distortion.end(), [](double k) { return std::isfinite(k); });
  if (!finite) return "distortion is not finite";
  if (!positive(frame.depth_scale_m))
    return fmt::format("depth scale {} m is not positive", frame.depth_scale_m.value());
  if (!msg::is_sensor_time(frame.readout_s) || !msg::is_sensor_time(frame.depth_offset_s)) {
    return fmt::format("readout time {} s or depth offset {} s is not within +-{:g} s", frame.readout_s.value(),
                       frame.depth_offset_s.value(), msg::kMaxSensorTime_s);
  }
  return {};
}

RgbdImage view_image(const msg::RgbdFrame& frame) {
  const int rows = static_cast<int>(frame.height), cols = static_cast<int>(frame.width);
  RgbdImage image;
  image.seq = frame.seq;
  image.stamp_ns = frame.stamp_ns;
  image.color_bgr = view_color(frame);
  image.depth = cv::Mat(rows, cols, CV_16UC1, const_cast<std::uint16_t*>(frame.depth.data()));
  image.depth_scale_m = frame.depth_scale_m;
  const auto [fx, fy, cx, cy] = msg::aligned(frame.intrinsics);
  image.camera = geometry::CameraModel({fx, fy, cx, cy, msg::aligned(frame.distortion), cols, rows});
  image.readout_s = frame.readout_s;
  image.depth_offset_s = frame.depth_offset_s;
  return image;
}

cv::Mat view_color(const msg::RgbdFrame& frame) {
  if (!msg::is_plausible(frame)) return {};
  // cv::Mat has no const view; nothing may write to it.
  return {static_cast<int>(frame.height), static_cast<int>(frame.width), CV_8UC3,
          const_cast<std::uint8_t*>(frame.color_bgr.data())};
}

}  // namespace rtd::vision
