// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// What images of a camera can be.
namespace rtd::msg {

/// Either side of a frame may be as short and as long as this, and no frame has more pixels than the largest size
/// class.
inline constexpr std::uint32_t kMinFrameSide = 8, kMaxFrameSide = 1920;
inline constexpr std::size_t kMaxFramePixels = std::size_t{1920} * 1200;

constexpr bool is_frame_size(std::uint64_t width, std::uint64_t height) {
  return std::min(width, height) >= kMinFrameSide && std::max(width, height) <= kMaxFrameSide &&
         width * height <= kMaxFramePixels;
}

/// Whether fx fy cx cy (px) belong to an image of this size: the focal lengths of a lens that sees from about half a
/// degree to almost everything, and an image that may have been cut out of a larger one.
inline bool is_camera(const std::array<double, 4>& intrinsics, std::uint32_t width, std::uint32_t height) {
  const auto [fx, fy, cx, cy] = intrinsics;
  const double side = std::max(width, height), longest_px = 128 * side, farthest_px = 16 * side;
  return fx >= 1 && fy >= 1 && fx <= longest_px && fy <= longest_px && std::abs(cx) <= farthest_px &&
         std::abs(cy) <= farthest_px;
}

}  // namespace rtd::msg
