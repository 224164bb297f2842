// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/camera/core/image_files.hpp"
#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {

/// "/camera/rgb/image_color recorded at 1305031102175304000 ns": for messages.
std::string name_of(const RecordedMessage& message);

/// sensor_msgs/Image (rgb8, bgr8, rgba8, bgra8, mono8) or CompressedImage (JPEG, PNG) as CV_8UC3 BGR. Throws
/// SourceError for an encoding that cannot be read, naming it and those that can: it is the topic's, not the frame's.
ImageRead decode_color(const RecordedMessage& message, const std::string& type);

/// sensor_msgs/Image (16UC1, mono16, 32FC1) or CompressedImage (16-bit PNG, compressedDepth) as CV_16UC1, 0 = no
/// measurement: NaN, infinity, saturation, nothing in front of the camera. Floats become units of float_unit_m; what
/// does not fit is no measurement. Throws SourceError as above.
ImageRead decode_depth(const RecordedMessage& message, const std::string& type, double float_unit_m);

/// Metres of a unit of what decode_depth() makes of such a message. Throws SourceError and ros::WireError.
double depth_unit_m(const RecordedMessage& message, const std::string& type, double float_unit_m);

}  // namespace rtd::camera
