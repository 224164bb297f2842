// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/ros2/message_fields.hpp"

namespace rtd::ros2 {

/// The structs of an IDL text of ours by "package/Type": modules PACKAGE msg dds_, names that end with an underscore,
/// primitive types, strings, arrays and sequences. Types by the words of .msg files.
std::map<std::string, std::vector<MessageField>> idl_fields(const std::string& idl, const std::string& package);

/// The fields of "package/Type", of ours or of common/ros2/msg; null when it is neither.
const std::vector<MessageField>* known_fields(const std::string& type);

/// "nav_msgs::msg::dds_::Odometry_" -> "nav_msgs/Odometry"; empty for a name that is no message of ROS 2.
std::string short_type(const std::string& dds_type);

}  // namespace rtd::ros2
