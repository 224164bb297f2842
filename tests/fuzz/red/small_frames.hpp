// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/se3.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::testing {

/// Small frames of a textured wall in front of which a block moves: what a camera would send, at a fraction of the
/// work.
class SmallFrames {
 public:
  static constexpr std::uint32_t kWidth = 96, kHeight = 72;
  static constexpr std::int64_t stamp_ns(std::uint64_t seq) {
    return 1'000'000'000'000 + static_cast<std::int64_t>(seq) * 33'333'333;
  }
  /// To and fro before the wall.
  static Eigen::Isometry3d T_world_camera(std::uint64_t seq) {
    geometry::Vector6d twist;
    twist << 0.1 * std::sin(0.05 * static_cast<double>(seq)), 0, 0, 0, 0, 0;
    return geometry::se3_exp(twist);
  }

  /// The frame in place: other fields than before are those of a good camera.
  static void paint(std::uint64_t seq, msg::RgbdFrame& frame) {
    constexpr double kFocal_px = 80, kWall_m = 2.5, kBlock_m = 1.5;
    frame.seq = seq;
    frame.stamp_ns = stamp_ns(seq);
    frame.published_ns = stamp_ns(seq) + 1'000'000;
    frame.intrinsics = msg::unaligned(std::array<double, 4>{kFocal_px, kFocal_px, kWidth / 2.0, kHeight / 2.0});
    frame.distortion = {};
    frame.depth_scale_m = 0.001;
    frame.readout_s = frame.depth_offset_s = 0.0;
    frame.width = kWidth;
    frame.height = kHeight;
    frame.lens = frame.reserved = 0;
    frame.source_id = 1;
    const double shift_px = kFocal_px * T_world_camera(seq).translation().x();
    const int left = static_cast<int>(seq % kWidth);
    for (std::uint32_t row = 0; row < kHeight; ++row) {
      for (std::uint32_t column = 0; column < kWidth; ++column) {
        const std::size_t at = std::size_t{row} * kWidth + column;
        const bool block = std::abs(static_cast<int>(column) - left) < 12 && row > 20 && row < 60;
        const double away_m = block ? kBlock_m : kWall_m;
        const auto x = static_cast<std::uint32_t>(static_cast<int>(column + shift_px / away_m) + 1000);
        const std::uint32_t tile = (x / 5 * 7919U) ^ (row / 5 * 104'729U) ^ (block ? 77U : 0U);
        for (std::size_t channel = 0; channel < 3; ++channel)
          frame.color_bgr[3 * at + channel] = static_cast<std::uint8_t>(tile * 2'654'435'761U >> 24U);
        frame.depth[at] = static_cast<std::uint16_t>(1000 * away_m);
      }
    }
  }
};

}  // namespace rtd::testing
