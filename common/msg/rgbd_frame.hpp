// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>

#include "common/msg/fields.hpp"
#include "common/msg/frame_size.hpp"

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

/// One colour image with its registered depth image.
///
/// Plain and of fixed size, so that it can be loaned from shared memory; the member order leaves no padding, and any
/// multiple of 4 can be its address. There is one such type and topic per size class, named after its largest image:
/// images with fewer pixels use the first width*height pixels, rows are packed (stride = width).
template <std::uint32_t kClassWidth, std::uint32_t kClassHeight>
struct SizedFrame {
  static constexpr std::size_t kPixels = std::size_t{kClassWidth} * kClassHeight;

  Unaligned<std::uint64_t> seq;          ///< counts the frames of one source from 0, without gaps
  Unaligned<std::int64_t> stamp_ns;      ///< acquisition time of the colour image, in the source's own clock
  Unaligned<std::int64_t> published_ns;  ///< CLOCK_MONOTONIC of the camera host when the frame was handed to the bus
  std::array<Unaligned<double>, 4> intrinsics;  ///< fx fy cx cy, px
  std::array<Unaligned<double>, 8> distortion;  ///< as geometry::CameraModel::Parameters
  Unaligned<double> depth_scale_m;              ///< metres of one depth unit (TUM: 1/5000)
  /// Readout time of the colour image's rolling shutter, first row to last, s; the stamp belongs to the middle row. 0 =
  /// all rows at once, or unknown.
  Unaligned<double> readout_s;
  Unaligned<double> depth_offset_s;    ///< time of the depth image minus that of the colour image, s; 0 = same, unknown
  std::uint32_t width;                 ///< px, is_frame_size(); width * height <= kPixels
  std::uint32_t height;                ///< px
  std::uint32_t lens;                  ///< geometry::Lens
  std::uint32_t reserved;              ///< 0
  Unaligned<std::uint64_t> source_id;  ///< random per camera process: distinguishes two cameras on one topic
  std::array<std::uint8_t, kPixels * 3> color_bgr;  ///< 8-bit BGR
  std::array<std::uint16_t, kPixels> depth;         ///< raw depth, 0 = no measurement
};

using RgbdFrame = SizedFrame<640, 480>;
using RgbdFrame848 = SizedFrame<848, 480>;
using RgbdFrame1280 = SizedFrame<1280, 720>;
using RgbdFrame1920 = SizedFrame<1920, 1200>;

#define RTD_FRAME_FIELDS(Type, name)                                                                          \
  static_assert(std::is_trivially_copyable_v<Type> && std::is_standard_layout_v<Type> && alignof(Type) == 4); \
  RTD_FIELDS_OF(Type, name, seq, stamp_ns, published_ns, intrinsics, distortion, depth_scale_m, readout_s,    \
                depth_offset_s, width, height, lens, reserved, source_id, color_bgr, depth)
RTD_FRAME_FIELDS(RgbdFrame, "rtd_msgs/RgbdFrame")
RTD_FRAME_FIELDS(RgbdFrame848, "rtd_msgs/RgbdFrame848")
RTD_FRAME_FIELDS(RgbdFrame1280, "rtd_msgs/RgbdFrame1280")
RTD_FRAME_FIELDS(RgbdFrame1920, "rtd_msgs/RgbdFrame1920")
#undef RTD_FRAME_FIELDS

/// Calls visit.operator()<Frame>() with the type of each size class, smallest first.
template <class Visit>
constexpr void for_each_frame_type(Visit&& visit) {
  visit.template operator()<RgbdFrame>();
  visit.template operator()<RgbdFrame848>();
  visit.template operator()<RgbdFrame1280>();
  visit.template operator()<RgbdFrame1920>();
}

/// Whether an image of this size fits into `pixels` pixels of a message.
constexpr bool fits(std::uint64_t width, std::uint64_t height, std::size_t pixels) {
  return is_frame_size(width, height) && width * height <= pixels;
}

template <std::uint32_t kWidth, std::uint32_t kHeight>
const char* broken_rule(const SizedFrame<kWidth, kHeight>& frame) {
  if (!fits(frame.width, frame.height, SizedFrame<kWidth, kHeight>::kPixels)) return "width and height";
  return is_camera(aligned(frame.intrinsics), frame.width, frame.height) ? nullptr : "intrinsics";
}

/// A frame of any size class as its receivers see it: the fields of SizedFrame, and where its pixels are.
struct FrameView {
  FrameView() = default;
  /// Of `frame`, which must outlive the view unless `memory` owns it.
  template <std::uint32_t kWidth, std::uint32_t kHeight>
  FrameView(const SizedFrame<kWidth, kHeight>& frame,  // NOLINT(google-explicit-constructor): the same to its readers
            std::shared_ptr<const void> memory = {})
      : seq(frame.seq),
        stamp_ns(frame.stamp_ns),
        published_ns(frame.published_ns),
        intrinsics(aligned(frame.intrinsics)),
        distortion(aligned(frame.distortion)),
        depth_scale_m(frame.depth_scale_m),
        readout_s(frame.readout_s),
        depth_offset_s(frame.depth_offset_s),
        width(frame.width),
        height(frame.height),
        lens(frame.lens),
        source_id(frame.source_id),
        color_bgr(frame.color_bgr.data()),
        depth(frame.depth.data()),
        pixels(frame.depth.size()),
        owner(std::move(memory)) {}

  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t published_ns = 0;
  std::array<double, 4> intrinsics{};
  std::array<double, 8> distortion{};
  double depth_scale_m = 0;
  double readout_s = 0;
  double depth_offset_s = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t lens = 0;
  std::uint64_t source_id = 0;
  const std::uint8_t* color_bgr = nullptr;
  const std::uint16_t* depth = nullptr;
  std::size_t pixels = 0;             ///< that the message has room for
  std::shared_ptr<const void> owner;  ///< of the memory of the pixels
};
inline bool is_plausible(const FrameView& frame) {
  return fits(frame.width, frame.height, frame.pixels);
}

}  // namespace rtd::msg
