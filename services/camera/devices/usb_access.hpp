// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rtd::camera {

/// The file of deploy/ that lets members of the group `video` open USB cameras: for messages.
inline constexpr const char* kUdevRules = "deploy/udev/60-rtd-cameras.rules";

/// "1d27/0609@1/5" (vendor/product@bus/device, OpenNI2's name of a USB device) -> "/dev/bus/usb/001/005"; empty when
/// the name is of another kind.
std::optional<std::string> usb_node(const std::string& uri);

/// "...: the user may not open it; ...": cause and fix for a device file that exists but may not be opened.
std::string no_permission(const std::string& device, const std::string& node);

}  // namespace rtd::camera
