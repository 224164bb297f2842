// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/device_factory.hpp"

#include "services/camera/core/frame_source.hpp"
#ifdef RTD_HAS_OPENNI2
#include "services/camera/devices/openni2_device.hpp"
#endif

namespace rtd::camera {

std::unique_ptr<LiveDevice> make_device(const DeviceUri& uri) {
#ifdef RTD_HAS_OPENNI2
  if (uri.scheme == "openni2") return make_openni2_device(uri.device);
#endif
  if (uri.scheme == "openni2") {
    throw SourceError("source '" + uri.text +
                      "': this build has no OpenNI2; install libopenni2-dev, then configure and build again");
  }
  throw SourceError("source '" + uri.text + "': " + uri.scheme + ": is not supported by this build");
}

std::vector<FoundCamera> find_cameras() {
  std::vector<FoundCamera> cameras;
#ifdef RTD_HAS_OPENNI2
  cameras = find_openni2_cameras();
#endif
  return cameras;
}

std::string supported_devices() {
#ifdef RTD_HAS_OPENNI2
  return "openni2";
#else
  return "not openni2: it needs libopenni2-dev when this program is built";
#endif
}

}  // namespace rtd::camera
