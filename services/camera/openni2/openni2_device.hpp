// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/camera/live_uri.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {

/// A camera of OpenNI2 (PrimeSense, Xtion, Astra, Kinect v1 with libfreenect's driver) or an .oni file, played
/// image by image; not opened. Depth is registered to colour by the camera, both are synchronised where it can, nothing
/// is mirrored. The lens is what the driver says about its field of view. The device of `uri` is OpenNI2's name, a
/// file, or empty for the first camera. Throws SourceError when this build has no OpenNI2, naming the package.
std::unique_ptr<LiveDevice> make_openni2_device(const DeviceUri& uri);

/// The cameras that OpenNI2's drivers find on this host. Opens each for its modes, starts none.
std::vector<FoundCamera> find_openni2_cameras();

/// Whether this build has OpenNI2.
bool supports_openni2();

}  // namespace rtd::camera
