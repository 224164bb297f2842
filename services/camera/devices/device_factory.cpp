// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/device_factory.hpp"

#include <fmt/format.h>

#include "common/camera/frame_source.hpp"
#ifdef RTD_HAS_OPENNI2
#include "services/camera/devices/openni2_device.hpp"
#endif

namespace rtd::camera {

std::unique_ptr<LiveDevice> make_device(const DeviceUri& uri) {
#ifdef RTD_HAS_OPENNI2
  if (uri.scheme == "openni2") return make_openni2_device(uri.device);
#endif
  throw SourceError(
      fmt::format("source '{}': this build has no {}; install libopenni2-dev, then configure and build again", uri.text,
                  uri.scheme));
}

std::vector<FoundCamera> find_cameras() {
#ifdef RTD_HAS_OPENNI2
  return find_openni2_cameras();
#else
  return {};
#endif
}

std::string supported_devices() {
#ifdef RTD_HAS_OPENNI2
  return "openni2";
#else
  return "not openni2 (libopenni2-dev was missing when this program was built)";
#endif
}

}  // namespace rtd::camera
