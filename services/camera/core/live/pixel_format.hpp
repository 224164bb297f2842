// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/camera/image_files.hpp"
#include "services/camera/core/live/device_modes.hpp"

namespace rtd::camera {

/// Formats of devices, rows without bytes between them. Colour: RGB8, BGR8, GREY, YUYV, UYVY, MJPG. Depth: Z16, 16-bit
/// little endian in units of the device.
bool readable(const std::string& format, Stream stream);

/// "RGB8, BGR8, ...": for messages.
std::string readable_formats(Stream stream);

/// Smaller is better: what loses and costs least comes first.
int preference(const std::string& format);

/// CV_8UC3 BGR or CV_16UC1, 0 = no measurement; a problem when the bytes are not those of such an image. `name` is for
/// messages.
ImageRead decode_image(const DeviceMode& mode, const std::vector<std::uint8_t>& bytes, const std::string& name);

/// Why the bytes cannot be an image of this mode; empty when they can. Compressed images are not looked into.
std::string wrong_size(const DeviceMode& mode, std::size_t bytes);

}  // namespace rtd::camera
