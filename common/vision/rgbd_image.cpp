// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/rgbd_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/msg/rgbd_frame.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::vision {
namespace {

constexpr double kMaxDepthScale_m = 1;  // a metre per unit

}  // namespace

std::string defect(const msg::FrameView& frame) {
  if (!msg::is_plausible(frame)) {
    return fmt::format("size {}x{} does not fit into the {} pixels of the message", frame.width, frame.height,
                       frame.pixels);
  }
  const auto [fx, fy, cx, cy] = frame.intrinsics;
  if (!msg::is_camera(frame.intrinsics, frame.width, frame.height)) {
    return fmt::format("intrinsics fx {} fy {} cx {} cy {} are not a camera", fx, fy, cx, cy);
  }
  const bool finite =
      std::all_of(frame.distortion.begin(), frame.distortion.end(), [](double k) { return std::isfinite(k); });
  if (!finite) return "distortion is not finite";
  if (frame.lens > static_cast<std::uint32_t>(geometry::Lens::kFisheye))
    return fmt::format("lens model {} is unknown", frame.lens);
  if (!(frame.depth_scale_m > 0 && frame.depth_scale_m <= kMaxDepthScale_m))
    return fmt::format("depth scale {} m is not in (0, {:g}] m", frame.depth_scale_m, kMaxDepthScale_m);
  if (!msg::is_sensor_time(frame.readout_s) || !msg::is_sensor_time(frame.depth_offset_s)) {
    return fmt::format("readout time {} s or depth offset {} s is not within +-{:g} s", frame.readout_s,
                       frame.depth_offset_s, msg::kMaxSensorTime_s);
  }
  return {};
}

RgbdImage view_image(const msg::FrameView& frame) {
  const int rows = static_cast<int>(frame.height), cols = static_cast<int>(frame.width);
  RgbdImage image;
  image.seq = frame.seq;
  image.stamp_ns = frame.stamp_ns;
  image.color_bgr = view_color(frame);
  image.depth = cv::Mat(rows, cols, CV_16UC1, const_cast<std::uint16_t*>(frame.depth));
  image.depth_scale_m = frame.depth_scale_m;
  const auto [fx, fy, cx, cy] = frame.intrinsics;
  image.camera =
      geometry::CameraModel({fx, fy, cx, cy, frame.distortion, cols, rows, static_cast<geometry::Lens>(frame.lens)});
  image.readout_s = frame.readout_s;
  image.depth_offset_s = frame.depth_offset_s;
  return image;
}

cv::Mat view_color(const msg::FrameView& frame) {
  if (!msg::is_plausible(frame)) return {};
  // cv::Mat has no const view; nothing may write to it.
  return {static_cast<int>(frame.height), static_cast<int>(frame.width), CV_8UC3,
          const_cast<std::uint8_t*>(frame.color_bgr)};
}

}  // namespace rtd::vision
