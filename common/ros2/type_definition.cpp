// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_definition.hpp"

#include <algorithm>
#include <sstream>
#include <vector>

#include "common/ros2/definition_texts.hpp"
#include "common/ros2/message_fields.hpp"
#include "common/ros2/names.hpp"

namespace rtd::ros2 {
namespace {

constexpr const char* kOwnPackage = "rtd_msgs::msg::dds_::";
const std::string kSeparator(80, '=');  // between the types of one text, as rosbag2 has it

/// The types that one is made of, each once, the type itself first.
std::vector<std::string> closure(const std::string& type) {
  std::vector<std::string> all{type};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string package = all[i].substr(0, all[i].find('/'));
    for (const MessageField& field : fields_of(message_texts().at(all[i]), package)) {
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
    text += message_texts().at(part);
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
  if (dds_type.starts_with(kOwnPackage)) {
    const std::string name = dds_type.substr(std::string(kOwnPackage).size());
    if (own_idl().find("struct " + name + " {") != std::string::npos) return {dds_type, "omgidl", idl_text()};
  }
  const std::string ros_name = ros_type(dds_type);
  const std::size_t infix = ros_name.find("/msg/");
  if (infix == std::string::npos) return {ros_name, {}, {}};
  const std::string short_name = ros_name.substr(0, infix) + ros_name.substr(infix + 4);
  if (!message_texts().contains(short_name)) return {ros_name, {}, {}};
  return {ros_name, "ros2msg", ros2msg_text(short_name)};
}

}  // namespace rtd::ros2
