// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/frame_messages.hpp"

#include <algorithm>

namespace rtd::filter {
namespace {

bool removed(const msg::Feature& feature) {
  return (feature.flags & msg::kFeatureRemoved) != 0;
}

}  // namespace

void fill_message(const msg::RgbdFrame& frame, const FilterResult& result, msg::DetectionUse use,
                  msg::FeatureFrame& message) {
  message = {};
  message.seq = frame.seq;
  message.stamp_ns = frame.stamp_ns;
  message.published_ns = frame.published_ns;
  message.intrinsics = msg::aligned(frame.intrinsics);
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
