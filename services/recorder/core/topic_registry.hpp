// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/ros2/type_description.hpp"

namespace rtd::recorder {

/// Which topics are recorded: shell patterns (* ? [a-z], a star also crosses slashes) on the DDS name or the ROS 2
/// name. For a robot with a name: not those of other robots, and the patterns may leave its name out.
class TopicFilter {
 public:
  explicit TopicFilter(std::vector<std::string> patterns, std::string robot = {})
      : patterns_(std::move(patterns)), robot_(std::move(robot)) {}
  bool wants(const std::string& dds_topic) const;

 private:
  std::vector<std::string> patterns_;
  std::string robot_;
};

struct TopicCounts {
  std::uint64_t written = 0, written_bytes = 0;  ///< in the file or its open chunk
  std::uint64_t acknowledged = 0;                ///< on disk
  std::uint64_t lost_in_transit = 0;             ///< sent by a writer but not received
  std::uint64_t lost_in_queue = 0;               ///< the disk was too slow
  std::uint64_t lost() const { return lost_in_transit + lost_in_queue; }
};

struct RecordedTopic {
  std::string dds_name, dds_type;
  std::string name;  ///< in the recording: /slam/odometry, rtd/frame
  ros2::TypeDefinition type;
  std::vector<bus::RawQos> offered;  ///< each kind of QoS once
  TopicCounts counts;
};

/// The topics of a recording and what became of their messages. A topic is its index, which never changes. Thread-safe.
class TopicRegistry {
 public:
  std::size_t find_or_add(const std::string& dds_name, const std::string& dds_type);
  void add_offer(std::size_t topic, const bus::RawQos& qos);
  /// Describes a type that is not built in; a text that came before stays.
  void learn(const std::string& dds_type, const ros2::TypeDefinition& definition);
  /// Whether the text of the type is there.
  bool knows(const std::string& dds_type) const;

  /// Calls `change` with the counts of a topic.
  void count(std::size_t topic, auto change) {
    const std::lock_guard lock(mutex_);
    change(topics_[topic].counts);
  }
  void count_acknowledged(const std::vector<std::uint64_t>& per_topic);

  RecordedTopic topic(std::size_t index) const;
  std::vector<RecordedTopic> topics() const;
  TopicCounts totals() const;

 private:
  ros2::TypeDefinition definition_of(const std::string& dds_type) const;

  mutable std::mutex mutex_;
  std::vector<RecordedTopic> topics_;
  std::map<std::string, ros2::TypeDefinition> learned_;  ///< by DDS name
};

}  // namespace rtd::recorder
