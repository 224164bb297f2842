// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "common/msg/fields.hpp"
#include "common/msg/unaligned.hpp"

namespace rtd::msg {

inline constexpr std::uint32_t kMaxFrameWidth = 640;
inline constexpr std::uint32_t kMaxFrameHeight = 480;
inline constexpr std::size_t kMaxFramePixels = std::size_t{kMaxFrameWidth} * kMaxFrameHeight;

/// One colour image with its registered depth image: topic `rtd/frame`.
///
/// Plain and of fixed size, so that it can be loaned from shared memory; the member order leaves no padding, and every
/// multiple of 4 will do as its address.
/// Images smaller than 640x480 use the first width*height pixels, rows are packed (stride = width).
struct RgbdFrame {
  Unaligned<std::uint64_t> seq;          ///< counts the frames of one source from 0, no gaps at the source
  Unaligned<std::int64_t> stamp_ns;      ///< acquisition time of the colour image, in the source's own clock
  Unaligned<std::int64_t> published_ns;  ///< CLOCK_MONOTONIC of the camera host when the frame was handed to the bus
  std::array<Unaligned<double>, 4> intrinsics;  ///< fx fy cx cy, px
  std::array<Unaligned<double>, 5> distortion;  ///< Brown-Conrady k1 k2 p1 p2 k3 (OpenCV order), zero when rectified
  Unaligned<double> depth_scale_m;              ///< metres of one depth unit (TUM: 1/5000)
  std::uint32_t width;                          ///< px, <= kMaxFrameWidth
  std::uint32_t height;                         ///< px, <= kMaxFrameHeight
  Unaligned<std::uint64_t> source_id;           ///< random per camera process: tells two cameras on one topic apart
  std::array<std::uint8_t, kMaxFramePixels * 3> color_bgr;  ///< 8-bit BGR
  std::array<std::uint16_t, kMaxFramePixels> depth;         ///< raw depth, 0 = no measurement
};
static_assert(std::is_trivially_copyable_v<RgbdFrame> && std::is_standard_layout_v<RgbdFrame>);
RTD_FIELDS(rtd_msgs, RgbdFrame, seq, stamp_ns, published_ns, intrinsics, distortion, depth_scale_m, width, height,
           source_id, color_bgr, depth)
static_assert(alignof(RgbdFrame) == 4);

}  // namespace rtd::msg
