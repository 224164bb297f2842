// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace rtd::ros2 {

/// A field of a message type, in the words of .msg files.
struct MessageField {
  enum class Kind { kOne, kArray, kSequence };
  std::string type;  ///< "float64", "string", or a message: "geometry_msgs/Pose"
  std::string name;
  Kind kind = Kind::kOne;
  std::uint32_t capacity = 0;  ///< of an array
  bool is_message() const { return type.find('/') != std::string::npos; }
};

/// The fields of message types by "package/Type".
using MessageFields = std::map<std::string, std::vector<MessageField>>;

/// Every type that the bus carries, and all that they are made of: the lists of common/msg.
const MessageFields& message_fields();

/// The fields of "package/Type"; null when the type is unknown.
const std::vector<MessageField>* fields_of(const std::string& type);

}  // namespace rtd::ros2
