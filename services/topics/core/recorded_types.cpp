// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/core/recorded_types.hpp"

#include "common/ros2/type_description.hpp"
#include "common/ros2/type_layout.hpp"

namespace rtd::topics {
namespace {

/// The text of IDL defines the same samples as ours, or does not define the type.
bool same_layout(const camera::RecordedTopic& topic) {
  const std::string name = topic.type.substr(topic.type.find('/') + 1) + '_';
  const std::string recorded = ros2::layout_in(topic.schema_text, name);
  const std::string ours = ros2::layout_in(ros2::own_idl(), name);
  return recorded.empty() || ours.empty() || recorded == ours;
}

void take_known(RecordedType& type, const camera::RecordedTopic& topic) {
  if (ros2::fields_of(topic.type) == nullptr) {
    type.problem =
        topic.schema_text.empty()
            ? "the recording does not define " + topic.type + ", and it is not known here"
            : topic.type + " is defined as " + topic.schema_encoding + ", which is not read, and it is not known here";
  } else if (!same_layout(topic)) {
    type.problem = topic.type + " was recorded by another version, with other fields";
  } else {
    type.fields = ros2::message_fields();
  }
}

}  // namespace

RecordedType type_of(const camera::RecordedTopic& topic) {
  RecordedType type{ros::package_and_type(topic.type), {}, {}};
  const bool defined = topic.schema_encoding == "ros1msg" || topic.schema_encoding == "ros2msg";
  if (!defined || topic.schema_text.empty()) {
    take_known(type, topic);
    return type;
  }
  try {
    type.fields = ros::parse_definition(type.type, topic.schema_text);
  } catch (const ros::DefinitionError& error) {
    type.problem = error.what();
  }
  return type;
}

std::map<std::string, RecordedType> types_of(const camera::Recording& recording) {
  std::map<std::string, RecordedType> types;
  for (const camera::RecordedTopic& topic : recording.topics()) types.try_emplace(topic.name, type_of(topic));
  return types;
}

}  // namespace rtd::topics
