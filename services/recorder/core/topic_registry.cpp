// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/core/topic_registry.hpp"

#include <algorithm>

#include "common/bus/robot.hpp"
#include "common/ros2/names.hpp"

namespace rtd::recorder {

bool TopicFilter::wants(const std::string& dds_topic) const {
  if (!robot_.empty() && !bus::concerns_robot(dds_topic, robot_)) return false;
  const std::string unnamed = robot_.empty() ? dds_topic : bus::split_robot(dds_topic).topic;
  const bool service = bus::is_internal_to_ros(dds_topic);
  return std::ranges::any_of(patterns_, [&](const std::string& pattern) {
    if (service && !bus::is_internal_to_ros(pattern)) return false;
    return ros2::matches_topic(pattern, dds_topic) || ros2::matches_topic(pattern, unnamed);
  });
}

std::size_t TopicRegistry::find_or_add(const std::string& dds_name, const std::string& dds_type) {
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find_if(
      topics_, [&](const RecordedTopic& topic) { return topic.dds_name == dds_name && topic.dds_type == dds_type; });
  if (known != topics_.end()) return static_cast<std::size_t>(known - topics_.begin());
  topics_.push_back({dds_name, dds_type, ros2::ros_topic(dds_name), definition_of(dds_type), {}, {}});
  return topics_.size() - 1;
}

void TopicRegistry::add_offer(std::size_t topic, const bus::RawQos& qos) {
  const std::lock_guard lock(mutex_);
  auto& offered = topics_[topic].offered;
  if (std::ranges::count(offered, qos) == 0) offered.push_back(qos);
}

void TopicRegistry::learn(const std::string& dds_type, const ros2::TypeDefinition& definition) {
  const std::lock_guard lock(mutex_);
  if (!definition.known() || !learned_.emplace(dds_type, definition).second) return;
  for (RecordedTopic& topic : topics_)
    if (topic.dds_type == dds_type) topic.type = definition_of(dds_type);
}

bool TopicRegistry::knows(const std::string& dds_type) const {
  const std::lock_guard lock(mutex_);
  return definition_of(dds_type).known();
}

ros2::TypeDefinition TopicRegistry::definition_of(const std::string& dds_type) const {
  ros2::TypeDefinition built_in = ros2::definition_of(dds_type);
  const auto learned = learned_.find(dds_type);
  return built_in.known() || learned == learned_.end() ? built_in : learned->second;
}

void TopicRegistry::count_acknowledged(const std::vector<std::uint64_t>& per_topic) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < per_topic.size(); ++i) topics_[i].counts.acknowledged = per_topic[i];
}

RecordedTopic TopicRegistry::topic(std::size_t index) const {
  const std::lock_guard lock(mutex_);
  return topics_.at(index);
}

std::vector<RecordedTopic> TopicRegistry::topics() const {
  const std::lock_guard lock(mutex_);
  return topics_;
}

TopicCounts TopicRegistry::totals() const {
  const std::lock_guard lock(mutex_);
  TopicCounts sum;
  for (const RecordedTopic& topic : topics_) {
    sum.written += topic.counts.written;
    sum.written_bytes += topic.counts.written_bytes;
    sum.acknowledged += topic.counts.acknowledged;
    sum.lost_in_transit += topic.counts.lost_in_transit;
    sum.lost_in_queue += topic.counts.lost_in_queue;
  }
  return sum;
}

}  // namespace rtd::recorder
