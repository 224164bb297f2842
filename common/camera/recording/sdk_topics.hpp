// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "common/camera/recording/recording.hpp"
#include "common/msg/ros.hpp"

/// What the SDKs of cameras record with their images. RealSense: in .bag messages of ROS, in .db3 (since 2026) texts
/// "key=value;key=value". Orbbec (SDK 2, in .bag and .mcap): a "stream profile" for each stream.
namespace rtd::camera {

/// The topic with the stream profile of an image of Orbbec's SDK; empty for topics of others.
std::string orbbec_profile_topic(const std::string& image_topic);

/// The calibration on a topic of CameraInfo, of RealSense's texts or of Orbbec's stream profiles. Throws
/// ros::WireError when it is damaged.
msg::CameraInfo recorded_camera_info(recordings::Reader& recording, const std::string& topic);

/// The unit of 16-bit depth: a message of RealSense's SDK, a property of Orbbec's; empty when none is recorded. Throws
/// SourceError for one that cannot be.
std::optional<double> sdk_depth_unit_m(recordings::Reader& recording, const std::string& depth_topic);

/// T_color_depth. RealSense records for each stream how points come from a reference stream (of the number at the end
/// of the topic) into it, Orbbec how those of depth, which is seen from the infrared camera, come into colour. Empty
/// for the topics of others.
std::optional<Eigen::Isometry3d> sdk_extrinsics(recordings::Reader& recording, const std::string& color_topic,
                                                const std::string& depth_topic);

}  // namespace rtd::camera
