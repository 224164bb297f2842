// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/robot_finder.hpp"

#include "common/bus/robot.hpp"

namespace rtd::bus {

RobotFinder::RobotFinder(const BusOptions& options, std::string topic, std::string dds_type)
    : topic_(std::move(topic)), dds_type_(std::move(dds_type)), bus_(connect_raw(options)) {
  bus_->watch([this](const TopicWriter& writer, WriterChange change) { note(writer, change); });
}

RobotFinder::~RobotFinder() {
  bus_->watch({});
}

void RobotFinder::note(const TopicWriter& writer, WriterChange change) {
  const RobotTopic name = split_robot(writer.topic.name);
  if (name.topic != topic_ || writer.topic.type != dds_type_) return;
  const std::lock_guard lock(mutex_);
  std::set<WriterId>& writers = writers_[name.robot];
  if (change == WriterChange::kGone) {
    writers.erase(writer.id);
  } else {
    writers.insert(writer.id);
  }
  if (writers.empty()) writers_.erase(name.robot);
}

std::set<std::string> RobotFinder::robots() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> names;
  for (const auto& [robot, writers] : writers_) names.insert(robot);
  return names;
}

}  // namespace rtd::bus
