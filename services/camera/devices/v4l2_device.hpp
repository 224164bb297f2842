// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/camera/core/live/live_device.hpp"
#include "services/camera/devices/device_factory.hpp"
#include "services/camera/devices/kernel_calls.hpp"

namespace rtd::camera {

/// A camera with two V4L2 nodes: `nodes` is "COLOR[,DEPTH]", "/dev/video0,/dev/video2"; without DEPTH it is the node
/// with Z16 images on the same plug. Depth (Z16) is taken as registered to colour, in mm; V4L2 knows no lens.
std::unique_ptr<LiveDevice> make_v4l2_device(const std::string& nodes, std::unique_ptr<KernelCalls> calls);

/// The nodes that capture, as one camera for each plug.
std::vector<FoundCamera> find_v4l2_cameras(KernelCalls& calls);

}  // namespace rtd::camera
