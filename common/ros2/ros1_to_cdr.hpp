// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/ros_codec/byte_cursor.hpp"
#include "common/ros_codec/message_definition.hpp"

namespace rtd::ros2 {

/// Types of ROS 1 as ROS 2 has them: headers without `seq`, `time` and `duration` as messages of builtin_interfaces,
/// `char` as uint8, names of fields in lower case with underscores.
ros::MessageFields as_ros2(ros::MessageFields types);

/// Turns messages of one type from ROS 1's encoding into ROS 2's CDR, field by field: the values stay, the counter
/// `seq` of headers goes. Thread-safe.
class Ros1ToCdr {
 public:
  /// `type`: "package/Type"; `types`: ros::parse_definition() of it, as ROS 1 has it. Throws ros::DefinitionError for a
  /// wstring, which ROS 1 does not have.
  Ros1ToCdr(std::string type, ros::MessageFields types);

  /// The message in CDR with its header. Memory is bounded by the bytes given, whatever they claim. Throws
  /// ros::WireError when they do not hold such a message.
  std::vector<std::uint8_t> operator()(ros::Bytes ros1) const;

 private:
  std::string type_;
  ros::MessageFields types_;
};

}  // namespace rtd::ros2
