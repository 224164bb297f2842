// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::bus {

/// Messages whose every byte follows from seq, so that a receiver can distinguish a whole one from a torn one.
inline void fill_frame(msg::RgbdFrame& frame, std::uint64_t seq) {
  frame.seq = seq;
  frame.stamp_ns = static_cast<std::int64_t>(seq) * 33'333'333;
  frame.published_ns = 0;
  frame.intrinsics = {525.0, 525.0, 319.5, 239.5};
  frame.distortion = {};
  frame.depth_scale_m = 1.0 / 5000.0;
  frame.readout_s = 0.02;
  frame.depth_offset_s = -0.01;
  frame.width = 640;
  frame.height = 480;
  frame.lens = frame.reserved = 0;
  frame.source_id = ~seq;
  std::memset(frame.color_bgr.data(), static_cast<int>(seq % 251), frame.color_bgr.size());
  std::memset(frame.depth.data(), static_cast<int>(seq % 241), frame.depth.size() * sizeof(frame.depth[0]));
}

inline bool equals_pattern(const msg::RgbdFrame& frame) {
  auto expected = std::make_unique<msg::RgbdFrame>();
  fill_frame(*expected, frame.seq);
  return std::memcmp(expected.get(), &frame, sizeof(frame)) == 0;
}

inline void fill_features(msg::FeatureFrame& features, std::uint64_t seq) {
  features = {};
  features.seq = seq;
  features.intrinsics = {525.0, 525.0, 319.5, 239.5};
  features.width = 640;
  features.height = 480;
  features.count = msg::kMaxFeatures;
  for (msg::Feature& feature : features.features) {
    feature.u_px = feature.v_px = static_cast<float>(seq % 127);
    feature.descriptor.fill(static_cast<std::uint8_t>(seq % 127));
  }
}

inline bool equals_pattern(const msg::FeatureFrame& features) {
  auto expected = std::make_unique<msg::FeatureFrame>();
  fill_features(*expected, features.seq);
  return std::memcmp(expected.get(), &features, sizeof(features)) == 0;
}

}  // namespace rtd::bus
