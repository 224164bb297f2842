// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/frame_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rtd::filter {
namespace {

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}
bool removed(const msg::Feature& feature) {
  return (feature.flags & msg::kFeatureRemoved) != 0;
}

}  // namespace

std::string defect(const msg::RgbdFrame& frame) {
  if (frame.width == 0 || frame.height == 0 || frame.width > msg::kMaxFrameWidth ||
      frame.height > msg::kMaxFrameHeight) {
    return fmt::format("size {}x{} is not within 1x1 .. {}x{}", frame.width, frame.height, msg::kMaxFrameWidth,
                       msg::kMaxFrameHeight);
  }
  const auto& [fx, fy, cx, cy] = frame.intrinsics;
  if (!positive(fx) || !positive(fy) || !std::isfinite(cx) || !std::isfinite(cy)) {
    return fmt::format("intrinsics fx {} fy {} cx {} cy {} are not a camera", fx, fy, cx, cy);
  }
  const bool finite =
      std::all_of(frame.distortion.begin(), frame.distortion.end(), [](double k) { return std::isfinite(k); });
  if (!finite) return "distortion is not finite";
  if (!positive(frame.depth_scale_m)) return fmt::format("depth scale {} m is not positive", frame.depth_scale_m);
  return {};
}

vision::RgbdImage view_image(const msg::RgbdFrame& frame) {
  const int rows = static_cast<int>(frame.height), cols = static_cast<int>(frame.width);
  vision::RgbdImage image;
  image.seq = frame.seq;
  image.stamp_ns = frame.stamp_ns;
  // cv::Mat has no const view; nobody writes to these.
  image.color_bgr = cv::Mat(rows, cols, CV_8UC3, const_cast<std::uint8_t*>(frame.color_bgr.data()));
  image.depth = cv::Mat(rows, cols, CV_16UC1, const_cast<std::uint16_t*>(frame.depth.data()));
  image.depth_scale_m = frame.depth_scale_m;
  const auto& [fx, fy, cx, cy] = frame.intrinsics;
  image.camera = geometry::CameraModel({fx, fy, cx, cy, frame.distortion, cols, rows});
  return image;
}

void fill_message(const msg::RgbdFrame& frame, const FilterResult& result, msg::DetectionUse use,
                  msg::FeatureFrame& message) {
  message = {};
  message.seq = frame.seq;
  message.stamp_ns = frame.stamp_ns;
  message.published_ns = frame.published_ns;
  message.intrinsics = frame.intrinsics;
  message.width = frame.width;
  message.height = frame.height;
  message.objects = static_cast<std::uint32_t>(result.objects.size());
  message.detection_use = use;
  message.stage_ms = result.stage_ms;
  const bool overfull = result.features.size() > msg::kMaxFeatures;
  for (const msg::Feature& feature : result.features) {
    if (message.count == msg::kMaxFeatures) break;
    if (overfull && removed(feature)) continue;
    message.features[message.count++] = feature;
    if (removed(feature)) ++message.removed;
  }
}

msg::Image make_mask(const msg::RgbdFrame& frame, const FilterResult& result) {
  const auto cells = [](std::uint32_t px) { return std::max(1U, px / kCellPx); };
  const bool judged = !result.motion.empty();
  msg::Image mask;
  mask.header = {msg::to_time(frame.stamp_ns), "camera_color_optical_frame"};
  mask.width = judged ? static_cast<std::uint32_t>(result.cells.columns) : cells(frame.width);
  mask.height = judged ? static_cast<std::uint32_t>(result.cells.rows) : cells(frame.height);
  mask.encoding = "mono8";
  mask.step = mask.width;
  mask.data.resize(std::size_t{mask.width} * mask.height, static_cast<std::uint8_t>(CellMotion::kStatic));
  std::transform(result.motion.begin(), result.motion.end(), mask.data.begin(),
                 [](CellMotion motion) { return static_cast<std::uint8_t>(motion); });
  return mask;
}

}  // namespace rtd::filter
