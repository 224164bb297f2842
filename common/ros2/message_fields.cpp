// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/message_fields.hpp"

#include <cctype>
#include <sstream>

namespace rtd::ros2 {
namespace {

/// "Pose[<=5]" as type, kind and capacity.
MessageField field_of(const std::string& type, const std::string& name, const std::string& package) {
  const std::size_t bracket = type.find('[');
  MessageField field{type.substr(0, bracket), name, MessageField::Kind::kOne, 0};
  if (std::isupper(static_cast<unsigned char>(field.type[0])) != 0) field.type = package + '/' + field.type;
  if (bracket == std::string::npos) return field;
  std::string size = type.substr(bracket + 1, type.size() - bracket - 2);
  field.kind = size.empty() ? MessageField::Kind::kSequence : MessageField::Kind::kArray;
  if (size.starts_with("<=")) {
    field.kind = MessageField::Kind::kBoundedSequence;
    size.erase(0, 2);
  }
  if (!size.empty()) field.capacity = static_cast<std::uint32_t>(std::stoul(size));
  return field;
}

}  // namespace

std::vector<MessageField> fields_of(const std::string& msg_text, const std::string& package) {
  std::vector<MessageField> fields;
  std::istringstream lines(msg_text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type, name, rest;
    if (!(words >> type >> name)) continue;
    words >> rest;
    const bool constant = name.find('=') != std::string::npos || rest.starts_with('=');
    if (!constant) fields.push_back(field_of(type, name, package));
  }
  return fields;
}

}  // namespace rtd::ros2
