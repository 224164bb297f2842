// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/camera/device_uri.hpp"

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

}  // namespace rtd::camera
