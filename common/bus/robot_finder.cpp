// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/robot_finder.hpp"

#include <utility>

#include "common/bus/robot.hpp"

namespace rtd::bus {

RobotFinder::RobotFinder(const BusOptions& options, std::string topic, std::string dds_type)
    : topic_(std::move(topic)), dds_type_(std::move(dds_type)), bus_(connect_raw(options)) {}

std::set<std::string> RobotFinder::robots() const {
  std::set<std::string> names;
  for (const TopicWriter& writer : bus_->writers()) {
    const RobotTopic name = split_robot(writer.topic.name);
    if (name.topic == topic_ && writer.topic.type == dds_type_) names.insert(name.robot);
  }
  return names;
}

}  // namespace rtd::bus
