// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::test_support {

/// A size and a camera that the bus lets pass.
inline void fill_camera(auto& frame, std::uint32_t width, std::uint32_t height) {
  frame.intrinsics = {525, 525, width / 2.0, height / 2.0};
  frame.width = width;
  frame.height = height;
}

/// The fields before the pixels: frame 0 of a plain camera.
template <std::uint32_t kWidth, std::uint32_t kHeight>
void fill_header(msg::SizedFrame<kWidth, kHeight>& frame, std::uint32_t width, std::uint32_t height) {
  frame.seq = 0;
  frame.stamp_ns = frame.published_ns = 0;
  frame.distortion = {};
  frame.depth_scale_m = 1.0 / 5000.0;
  frame.readout_s = frame.depth_offset_s = 0.0;
  frame.lens = frame.reserved = 0;
  frame.source_id = 0;
  fill_camera(frame, width, height);
}

}  // namespace rtd::test_support
