// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_definition.hpp"

#include <algorithm>
#include <sstream>
#include <vector>

#include "common/ros2/message_fields.hpp"
#include "common/ros2/names.hpp"

namespace rtd::ros2 {
namespace {

const std::string kSeparator(80, '=');  // between the types of one text, as rosbag2 has it

/// What the .msg files of ROS 2 hold besides fields.
std::string constants_of(const std::string& type) {
  if (type == "diagnostic_msgs/DiagnosticStatus") return "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n";
  if (type != "sensor_msgs/PointField") return {};
  return "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
         "uint8 FLOAT32=7\nuint8 FLOAT64=8\n";
}

std::string default_of(const std::string& type, const MessageField& field) {
  if (type != "geometry_msgs/Quaternion") return {};
  return field.name == "w" ? " 1" : " 0";
}

/// Types of the same package go without it, but for those that an older package has too.
std::string type_text(const MessageField& field, const std::string& package) {
  const bool ambiguous = field.type == "vision_msgs/Pose2D" || field.type == "vision_msgs/Point2D";
  const bool local = field.type.starts_with(package + '/') && !ambiguous;
  const std::string type = local ? field.type.substr(package.size() + 1) : field.type;
  if (field.kind == MessageField::Kind::kSequence) return type + "[]";
  return field.kind == MessageField::Kind::kOne ? type : type + '[' + std::to_string(field.capacity) + ']';
}

/// The .msg file of a type.
std::string msg_text(const std::string& type) {
  const std::string package = type.substr(0, type.find('/'));
  std::string text = constants_of(type);
  for (const MessageField& field : *fields_of(type)) {
    text += type_text(field, package) + ' ' + field.name + default_of(type, field) + '\n';
  }
  return text;
}

/// The types that one is made of, each once, the type itself first.
std::vector<std::string> closure(const std::string& type) {
  std::vector<std::string> all{type};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const MessageField& field : *fields_of(all[i])) {
      const bool known = std::find(all.begin(), all.end(), field.type) != all.end();
      if (field.is_message() && !known) all.push_back(field.type);
    }
  }
  return all;
}

std::string ros2msg_text(const std::string& type) {
  std::string text;
  for (const std::string& part : closure(type)) {
    if (!text.empty()) text += kSeparator + "\nMSG: " + part + '\n';
    text += msg_text(part);
  }
  return text;
}

/// Without preprocessor lines, which readers of schemas do not know.
std::string idl_text() {
  std::string text;
  std::istringstream lines(own_idl());
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) text += line + '\n';
  }
  return text;
}

}  // namespace

TypeDefinition definition_of(const std::string& dds_type) {
  const std::string type = short_type(dds_type);
  if (fields_of(type) == nullptr) return {ros_type(dds_type), {}, {}};
  if (type.starts_with("rtd_msgs/")) return {ros2::dds_type(ros_type(dds_type)), "omgidl", idl_text()};
  return {ros_type(dds_type), "ros2msg", ros2msg_text(type)};
}

}  // namespace rtd::ros2
