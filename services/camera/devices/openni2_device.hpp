// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/camera/core/live/live_device.hpp"
#include "services/camera/devices/device_factory.hpp"

namespace rtd::camera {

/// A camera of OpenNI2 (PrimeSense, Xtion, Astra, Kinect v1 with libfreenect's driver) or an .oni file, played
/// image by image. Depth is registered to colour by the camera, both are synchronised where it can, nothing is
/// mirrored. The lens is what the driver says about its field of view. `uri` is OpenNI2's, a file, or empty for the
/// first camera.
std::unique_ptr<LiveDevice> make_openni2_device(const std::string& uri);

/// The cameras that OpenNI2's drivers find.
std::vector<FoundCamera> find_openni2_cameras();

}  // namespace rtd::camera
