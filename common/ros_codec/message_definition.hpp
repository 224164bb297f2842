// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtd::ros {

/// A field of a message type, in the words of .msg files.
struct MessageField {
  enum class Kind { kOne, kArray, kSequence };
  std::string type;  ///< "float64", "string", "time", or a message: "geometry_msgs/Pose"
  std::string name;
  Kind kind = Kind::kOne;
  std::uint32_t capacity = 0;       ///< of an array; of a sequence: its bound, 0 without one
  std::uint32_t text_capacity = 0;  ///< bound of a string, 0 without one
  bool is_message() const { return type.find('/') != std::string::npos; }
};

/// The fields of message types by "package/Type".
using MessageFields = std::map<std::string, std::vector<MessageField>>;

/// A definition cannot be used; what() names the type, the line, the cause and what is expected.
class DefinitionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "nav_msgs/msg/Odometry" or "nav_msgs/Odometry" -> "nav_msgs/Odometry".
std::string package_and_type(const std::string& type);

/// Reads a message definition as a ROS 1 bag (message_definition), or an MCAP (ros1msg, ros2msg) holds it: the text of
/// `type`, then those of the types that it is made of, each behind a line of '=' and "MSG: package/Type". Constants and
/// default values are left out, bounds of strings and sequences too. What ROS 1 calls time and duration, char and
/// byte stays; a type without package is of the same package as its message, "Header" of std_msgs. The result has
/// `type` and all that it is made of. Throws DefinitionError: no fields, a type without text, a type within itself.
MessageFields parse_definition(const std::string& type, const std::string& text);

}  // namespace rtd::ros
