// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/device_factory.hpp"

#include <fmt/format.h>

#include <utility>

#include "services/camera/core/frame_source.hpp"
#ifdef RTD_HAS_OPENNI2
#include "services/camera/devices/openni2_device.hpp"
#endif
#ifdef RTD_HAS_V4L2
#include "services/camera/devices/v4l2_device.hpp"
#endif

namespace rtd::camera {

std::unique_ptr<LiveDevice> make_device(const DeviceUri& uri) {
#ifdef RTD_HAS_OPENNI2
  if (uri.scheme == "openni2") return make_openni2_device(uri.device);
#endif
#ifdef RTD_HAS_V4L2
  if (uri.scheme == "v4l2") return make_v4l2_device(uri.device, linux_calls());
#endif
  const std::string package = uri.scheme == "openni2" ? "libopenni2-dev" : "linux-libc-dev";
  throw SourceError(fmt::format("source '{}': this build has no {}; install {}, then configure and build again",
                                uri.text, uri.scheme, package));
}

std::vector<FoundCamera> find_cameras() {
  std::vector<FoundCamera> cameras;
#ifdef RTD_HAS_OPENNI2
  cameras = find_openni2_cameras();
#endif
#ifdef RTD_HAS_V4L2
  const std::unique_ptr<KernelCalls> calls = linux_calls();
  for (FoundCamera& camera : find_v4l2_cameras(*calls)) cameras.push_back(std::move(camera));
#endif
  return cameras;
}

std::string supported_devices() {
  std::string text;
#ifdef RTD_HAS_OPENNI2
  text += "openni2";
#else
  text += "not openni2 (libopenni2-dev was missing when this program was built)";
#endif
#ifdef RTD_HAS_V4L2
  text += ", v4l2";
#endif
  return text;
}

}  // namespace rtd::camera
