// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/robot_finder.hpp"

#include "common/bus/backend.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"

namespace rtd::detector {

RobotFinder::RobotFinder(const bus::BusOptions& options) : bus_(bus::connect_raw(options)) {
  bus_->watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { note(writer, change); });
}

RobotFinder::~RobotFinder() {
  bus_->watch({});
}

void RobotFinder::note(const bus::TopicWriter& writer, bus::WriterChange change) {
  const bus::RobotTopic name = bus::split_robot(writer.topic.name);
  if (name.topic != bus::topics::kColorJpeg.name) return;
  if (writer.topic.type != bus::dds_type_name(bus::MessageTraits<msg::CompressedImage>::kId)) return;
  const std::lock_guard lock(mutex_);
  std::set<bus::WriterId>& cameras = cameras_[name.robot];
  if (change == bus::WriterChange::kGone) {
    cameras.erase(writer.id);
  } else {
    cameras.insert(writer.id);
  }
  if (cameras.empty()) cameras_.erase(name.robot);
}

std::set<std::string> RobotFinder::robots() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> names;
  for (const auto& [robot, cameras] : cameras_) names.insert(robot);
  return names;
}

}  // namespace rtd::detector
