// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/usb_access.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace rtd::camera {

std::optional<std::string> usb_node(const std::string& uri) {
  unsigned vendor = 0, product = 0, bus = 0, device = 0;
  int used = 0;
  const int fields = std::sscanf(uri.c_str(), "%4x/%4x@%3u/%3u%n", &vendor, &product, &bus, &device, &used);
  if (fields != 4 || static_cast<std::size_t>(used) != uri.size()) return std::nullopt;
  return fmt::format("/dev/bus/usb/{:03}/{:03}", bus, device);
}

std::string no_permission(const std::string& device, const std::string& node) {
  return fmt::format(
      "{}: no permission to open {}: add the user to the group 'video' (sudo usermod -aG video $USER, then log in "
      "again) and install the udev rule: sudo cp {} /etc/udev/rules.d/ && sudo udevadm control --reload && sudo "
      "udevadm "
      "trigger",
      device, node, kUdevRules);
}

}  // namespace rtd::camera
