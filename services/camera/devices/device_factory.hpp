// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/camera/device_uri.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {

/// A camera found on this host.
struct FoundCamera {
  std::string uri;   ///< for --source
  std::string name;  ///< for people
  std::vector<DeviceMode> modes;
  std::string problem;  ///< why it cannot be used now; empty when it can
};

/// The device of an openni2: URI (realsense-dds: needs a bus, realsense_device.hpp), not opened. Throws SourceError
/// when this build has no support for it, naming the package.
std::unique_ptr<LiveDevice> make_device(const DeviceUri& uri);

/// The cameras of this host. Opens each for its modes, starts none.
std::vector<FoundCamera> find_cameras();

/// "openni2": what this build supports of them, and what is missing.
std::string supported_devices();

}  // namespace rtd::camera
