// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::ros2 {

/// A type as the schema of a recording has it.
struct TypeDefinition {
  std::string name;  ///< "nav_msgs/msg/Odometry"; a type of our own: "rtd_msgs::msg::dds_::RgbdFrame_", as in its text
  std::string encoding;  ///< "ros2msg", "omgidl", or empty for an unknown type
  std::string text;      ///< complete, with all types that it is made of
  bool known() const { return !encoding.empty(); }
};

/// By DDS name: "nav_msgs::msg::dds_::Odometry_".
TypeDefinition definition_of(const std::string& dds_type);

/// The text of idl/rtd_msgs.idl.
const std::string& own_idl();

}  // namespace rtd::ros2
