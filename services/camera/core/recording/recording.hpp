// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/ros_codec/wire.hpp"

namespace rtd::camera {

/// A topic of a recording; the type without ROS 2's "/msg": "sensor_msgs/Image".
struct RecordedTopic {
  std::string name, type;
  std::uint64_t messages = 0;
};

/// A message of a recording, not yet decoded.
struct RecordedMessage {
  std::string topic;
  std::int64_t recorded_ns = 0;
  ros::Wire wire = ros::Wire::kRos1;
  std::vector<std::uint8_t> bytes;
};

/// The first and last time of a topic.
struct TopicSpan {
  std::int64_t first_ns = 0, last_ns = 0;
};

/// A file with messages of many topics, whatever its format. Throws SourceError when the file cannot be used; damaged
/// pieces are left out and told by take_damages(). Not thread-safe.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual const std::string& name() const = 0;
  virtual const std::vector<RecordedTopic>& topics() const = 0;
  /// Empty when the topic has no message that can be read.
  virtual std::optional<RecordedMessage> first(const std::string& topic) = 0;
  virtual TopicSpan span(const std::string& topic) = 0;
  /// Begins to play these topics: next() gives their messages in the order of recording.
  virtual void play(const std::vector<std::string>& topics) = 0;
  virtual std::optional<RecordedMessage> next() = 0;
  /// What was found damaged since the last call, one line each.
  virtual std::vector<std::string> take_damages() = 0;
};

}  // namespace rtd::camera
