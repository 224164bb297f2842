// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/camera/frame_source.hpp"
#include "services/camera/openni2/openni2_device.hpp"

namespace rtd::camera {

std::unique_ptr<LiveDevice> make_openni2_device(const DeviceUri& uri) {
  throw SourceError(
      fmt::format("source '{}': this build has no {}; install libopenni2-dev, then configure and build again", uri.text,
                  uri.scheme));
}

std::vector<FoundCamera> find_openni2_cameras() {
  return {};
}

bool supports_openni2() {
  return false;
}

}  // namespace rtd::camera
