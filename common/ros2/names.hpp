// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

/// Converts between the names of topics and types in DDS and in ROS 2:
///   rt/slam/odometry                 <-> /slam/odometry          (a ROS topic begins with a slash)
///   rtd/frame                        <-> rtd/frame               (any other topic keeps its name)
///   nav_msgs::msg::dds_::Odometry_   <-> nav_msgs/msg/Odometry
///   KeyedSeq                         <-> KeyedSeq
namespace rtd::ros2 {

std::string ros_topic(const std::string& dds_topic);
std::string dds_topic(const std::string& ros_topic);
std::string ros_type(const std::string& dds_type);
std::string dds_type(const std::string& ros_type);

/// Whether a shell pattern (* ? [a-z], a star also crosses slashes) fits a topic in either spelling.
bool matches_topic(const std::string& pattern, const std::string& topic);

/// "nav_msgs::msg::dds_::Odometry_" -> "nav_msgs/Odometry"; empty for a name that is not a ROS 2 message type.
std::string short_type(const std::string& dds_type);

}  // namespace rtd::ros2
