// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/camera/image_files.hpp"
#include "common/camera/live_uri.hpp"

namespace rtd::camera {

enum class Stream { kColor, kDepth };

/// A size, rate and format of one of a device's streams.
struct DeviceMode {
  Stream stream = Stream::kColor;
  cv::Size size_px;
  double fps = 0;
  std::string format;  ///< as in pixel_format.hpp, or the device's own name of another
};

/// The mode of a stream that fits the request: readable, not larger than a frame may be; 640 x 480 at 30 Hz if nothing
/// is asked, else the largest at the rate nearest to 30 Hz. Throws DeviceError (kUnsupportedMode) naming the request
/// and all modes of the stream; `device` is for the message.
DeviceMode choose_mode(const std::vector<DeviceMode>& modes, Stream stream, const ModeRequest& request,
                       const std::string& device);

/// "640 x 480 RGB8 15, 30 Hz; 1280 x 720 MJPG 30 Hz": the modes of a stream; "none" without.
std::string list_modes(const std::vector<DeviceMode>& modes, Stream stream);

/// "colour" or "depth".
const char* to_string(Stream stream);

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
