// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/msg/rgbd_frame.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::vision {

/// Why a frame cannot be used (size, intrinsics or depth scale out of bounds); empty when it can.
std::string defect(const msg::RgbdFrame& frame);

/// The images of a message without copying: `frame` must outlive the result, which must not be written to.
RgbdImage view_image(const msg::RgbdFrame& frame);

}  // namespace rtd::vision
