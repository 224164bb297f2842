// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "services/camera/core/recording/recording.hpp"

namespace rtd::camera {

/// The topics of a camera that runs now, by their ROS names.
struct LiveTopics {
  std::string color, depth, info;
};

/// A message of one of them, not yet decoded; message.topic is the ROS name, message.recorded_ns when it came.
struct LiveMessage {
  RecordedMessage message;
  std::string type;  ///< plain_type()
};

/// Where the messages of a running camera come from. next() belongs to one thread, the rest is thread-safe.
class LiveFeed {
 public:
  virtual ~LiveFeed() = default;
  /// The oldest that waits; empty when none came within the time or the feed is closed.
  virtual std::optional<LiveMessage> next(std::chrono::milliseconds timeout) = 0;
  /// Leaves out what waits: it is old by now.
  virtual void clear() = 0;
  /// Ends it and wakes next().
  virtual void close() = 0;
  virtual bool closed() const = 0;
  virtual std::uint64_t dropped() const = 0;  ///< messages that were not fetched in time
  virtual std::int64_t now_ns() const = 0;    ///< clock of recorded_ns
  /// Who publishes a topic, for people: "nobody publishes it in DDS domain 0".
  virtual std::string state_of(const std::string& topic) const = 0;
};

}  // namespace rtd::camera
