// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/msg/features.hpp"
#include "common/msg/rgbd_frame.hpp"

namespace rtd::msg {

/// Whether the counts in a fixed-size message from outside stay within its arrays.
template <class T>
bool is_plausible(const T&) {
  return true;
}
inline bool is_plausible(const RgbdFrame& frame) {
  return frame.width > 0 && frame.width <= kMaxFrameWidth && frame.height > 0 && frame.height <= kMaxFrameHeight;
}
inline bool is_plausible(const FeatureFrame& features) {
  return features.count <= kMaxFeatures;
}

}  // namespace rtd::msg
