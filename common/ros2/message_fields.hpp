// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rtd::ros2 {

/// A field of a message type.
struct MessageField {
  enum class Kind { kOne, kArray, kSequence, kBoundedSequence };
  std::string type;  ///< "float64", "string", or a message: "geometry_msgs/Pose"
  std::string name;
  Kind kind = Kind::kOne;
  std::uint32_t capacity = 0;  ///< of an array or a bounded sequence
  bool is_message() const { return type.find('/') != std::string::npos; }
};

/// The fields of a .msg text, without constants, default values and comments; types of its own package get their
/// package.
std::vector<MessageField> fields_of(const std::string& msg_text, const std::string& package);

}  // namespace rtd::ros2
