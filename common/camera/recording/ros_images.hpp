// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "common/camera/image_files.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/geometry/camera_model.hpp"
#include "common/msg/camera_frame.hpp"
#include "common/msg/ros.hpp"
#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::camera {

inline constexpr double kMillimetre = 0.001;  ///< the unit of 16-bit depth in ROS (REP 118)
/// TUM's depth unit: floats are rounded to it unless the recording names its unit.
inline constexpr double kFloatDepthUnitM = 1.0 / 5000.0;
/// Metadata of the depth topic's channel in an MCAP file that we wrote: the units of a metre in the source's images.
inline constexpr const char* kDepthFactor = "depth_factor";

/// "/camera/rgb/image_color recorded at 1305031102175304000 ns": for messages.
std::string name_of(const RecordedMessage& message);

/// sensor_msgs/Image (color_encodings.hpp: RGB, grey, YUV 4:2:2, Bayer) or CompressedImage (JPEG, PNG) as CV_8UC3 BGR.
/// Throws SourceError for an encoding that cannot be read, naming it and those that can: it is the topic's, not the
/// frame's. Of 16-bit grey the upper eight of `grey_bits` become the image.
ImageRead decode_color(const RecordedMessage& message, int grey_bits = 16);

/// How many bits 16-bit grey (mono16, 16UC1) really has: those of all but the brightest hundredth of the pixels, 8 at
/// least. Infrared of 10 or 12 bits would be black otherwise. To be found of a first image and kept: the same light is
/// then the same grey. 16 for every other image.
int grey_bits(const RecordedMessage& message);

/// sensor_msgs/Image (16UC1, mono16, 32FC1) or CompressedImage (16-bit PNG, compressedDepth as PNG or RVL) as CV_16UC1,
/// 0 = no measurement: NaN, infinity, saturation, nothing in front of the camera. Floats become units of float_unit_m;
/// what does not fit is no measurement. Throws SourceError as above.
ImageRead decode_depth(const RecordedMessage& message, double float_unit_m);

/// Metres of a unit of what decode_depth() makes of such a message. Throws SourceError and ros::WireError.
double depth_unit_m(const RecordedMessage& message, double float_unit_m);

/// Whether such a message holds floats. Throws as above.
bool has_float_depth(const RecordedMessage& message);

/// What to give decode_depth() as float_unit_m for units of so many metres: the same, but a thousand times as much
/// where the message's floats are millimetres, although ROS has metres in floats. Throws as above.
double float_step(const RecordedMessage& message, double float_unit_m);

using msg::kCameraFrame;

/// The camera_info message of a camera, ROS conventions.
msg::CameraInfo to_camera_info(const geometry::CameraModel& camera, std::int64_t stamp_ns,
                               const std::string& frame_id = kCameraFrame);

/// The camera that a CameraInfo describes: K and D of the raw image, or P for a rectified one ("image_rect" in the
/// colour topic's name), of its region of interest and with its binning unless an image of `image_px` shows that it has
/// them already. Throws SourceError naming `origin`: not calibrated, a lens that is not known (lens_models.hpp), not
/// finite.
geometry::CameraModel to_camera_model(const msg::CameraInfo& info, const std::string& color_topic,
                                      const std::string& origin, cv::Size image_px = {});

}  // namespace rtd::camera
