// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "common/camera/recording/recording.hpp"
#include "common/msg/ros.hpp"

/// What the RealSense SDK and its Viewer record beside their images: in .bag as messages of ROS, in .db3 (since 2026)
/// as texts "key=value;key=value".
namespace rtd::camera {

/// Whether the message is such a text.
bool is_sdk_text(const RecordedMessage& message);

/// "width=640;height=480;fx=...;ppx=...;model=...;coeffs=..." as a CameraInfo. Throws ros::WireError when it is
/// damaged.
msg::CameraInfo sdk_camera_info(const RecordedMessage& message);

/// The unit of 16-bit depth; empty when none is recorded. Throws SourceError for one that cannot be.
std::optional<double> sdk_depth_unit_m(recordings::Reader& recording, const std::string& depth_topic);

/// T_color_depth: for each stream it is recorded how points come from a reference stream (of the number at the end of
/// the topic) into it. Empty for the topics of others.
std::optional<Eigen::Isometry3d> sdk_extrinsics(recordings::Reader& recording, const std::string& color_topic,
                                                const std::string& depth_topic);

}  // namespace rtd::camera
