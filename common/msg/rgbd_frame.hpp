// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "common/msg/fields.hpp"

namespace rtd::msg {

/// A number of 8 bytes that may lie on any multiple of 4, as in the shared memory of Fast DDS, whose samples begin 4
/// bytes behind a multiple of 8. Converts from and to the number; costs nothing.
template <class T>
class Unaligned {
 public:
  static_assert(std::is_arithmetic_v<T> && sizeof(T) == 8);
  using Number = T;

  Unaligned() = default;                                             ///< not initialised, like a plain number
  Unaligned(T value) { std::memcpy(bytes_, &value, sizeof value); }  // NOLINT(google-explicit-constructor)
  operator T() const { return value(); }                             // NOLINT(google-explicit-constructor)
  T value() const {
    T value;
    std::memcpy(&value, bytes_, sizeof value);
    return value;
  }

 private:
  alignas(4) std::byte bytes_[sizeof(T)];
};

template <std::size_t kSize, class T>
std::array<T, kSize> aligned(const std::array<Unaligned<T>, kSize>& numbers) {
  std::array<T, kSize> copy;
  std::copy(numbers.begin(), numbers.end(), copy.begin());
  return copy;
}

template <std::size_t kSize, class T>
std::array<Unaligned<T>, kSize> unaligned(const std::array<T, kSize>& numbers) {
  std::array<Unaligned<T>, kSize> copy;
  std::copy(numbers.begin(), numbers.end(), copy.begin());
  return copy;
}

inline constexpr std::uint32_t kMaxFrameWidth = 640;
inline constexpr std::uint32_t kMaxFrameHeight = 480;
inline constexpr std::size_t kMaxFramePixels = std::size_t{kMaxFrameWidth} * kMaxFrameHeight;

/// One colour image with its registered depth image: topic `rtd/frame`.
///
/// Plain and of fixed size, so that it can be loaned from shared memory; the member order leaves no padding, and any
/// multiple of 4 can be its address.
/// Images smaller than 640x480 use the first width*height pixels, rows are packed (stride = width).
struct RgbdFrame {
  Unaligned<std::uint64_t> seq;          ///< counts the frames of one source from 0, without gaps
  Unaligned<std::int64_t> stamp_ns;      ///< acquisition time of the colour image, in the source's own clock
  Unaligned<std::int64_t> published_ns;  ///< CLOCK_MONOTONIC of the camera host when the frame was handed to the bus
  std::array<Unaligned<double>, 4> intrinsics;  ///< fx fy cx cy, px
  std::array<Unaligned<double>, 5> distortion;  ///< Brown-Conrady k1 k2 p1 p2 k3 (OpenCV order), zero when rectified
  Unaligned<double> depth_scale_m;              ///< metres of one depth unit (TUM: 1/5000)
  /// Readout time of the colour image's rolling shutter, first row to last, s; the stamp belongs to the middle row. 0 =
  /// all rows at once, or unknown.
  Unaligned<double> readout_s;
  Unaligned<double> depth_offset_s;    ///< time of the depth image minus that of the colour image, s; 0 = same, unknown
  std::uint32_t width;                 ///< px, <= kMaxFrameWidth
  std::uint32_t height;                ///< px, <= kMaxFrameHeight
  Unaligned<std::uint64_t> source_id;  ///< random per camera process: distinguishes two cameras on one topic
  std::array<std::uint8_t, kMaxFramePixels * 3> color_bgr;  ///< 8-bit BGR
  std::array<std::uint16_t, kMaxFramePixels> depth;         ///< raw depth, 0 = no measurement
};
static_assert(std::is_trivially_copyable_v<RgbdFrame> && std::is_standard_layout_v<RgbdFrame>);
RTD_FIELDS(rtd_msgs, RgbdFrame, seq, stamp_ns, published_ns, intrinsics, distortion, depth_scale_m, readout_s,
           depth_offset_s, width, height, source_id, color_bgr, depth)
static_assert(alignof(RgbdFrame) == 4);
inline bool is_plausible(const RgbdFrame& frame) {
  return frame.width > 0 && frame.width <= kMaxFrameWidth && frame.height > 0 && frame.height <= kMaxFrameHeight;
}

}  // namespace rtd::msg
