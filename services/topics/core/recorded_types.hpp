// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/camera/recording/recording.hpp"
#include "common/ros_codec/message_definition.hpp"

namespace rtd::topics {

/// How the messages of a recorded topic are read.
struct RecordedType {
  std::string type;           ///< "package/Type"
  ros::MessageFields fields;  ///< of the type and all that it is made of
  std::string problem;        ///< why they cannot be read; empty when they can
};

/// By the definition in the recording (ros1msg, ros2msg); without one, or with one in IDL, by the types that are known
/// here. A type of our own must have the layout that it has in the recording.
RecordedType type_of(const camera::RecordedTopic& topic);

/// Of all topics, by their names.
std::map<std::string, RecordedType> types_of(const camera::Recording& recording);

}  // namespace rtd::topics
