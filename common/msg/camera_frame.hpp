// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::msg {

/// The optical frame of the colour camera, where neither its driver nor its recording names it (docs/frames.md).
inline constexpr const char* kCameraFrame = "camera_color_optical_frame";

}  // namespace rtd::msg
