// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "common/bus/topic_follower.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/camera/ros2/ros2_device.hpp"

namespace rtd::camera {

/// The topics of a ROS 2 camera driver, over a connection of its own. Each topic is read as its writers offer it
/// (TopicFollower): best effort where a writer offers no more (ROS 2's sensor data profile).
class Ros2Feed final : public LiveFeed {
 public:
  /// Throws BusError when the bus refuses.
  Ros2Feed(const bus::BusOptions& options, const LiveTopics& topics);

  std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) override { return queue_.pop_for(timeout); }
  void clear() override;
  void end_transforms() override { wants_transforms_ = false; }
  std::uint64_t dropped() const override { return queue_.dropped(); }
  std::int64_t now_ns() const override { return service::monotonic_ns(); }
  std::string state_of(const std::string& topic) const override;
  bool is_published(const std::string& topic) const override { return publishers(topic).readable > 0; }

 private:
  struct Publishers {
    int readable = 0;
    std::string other_type;  ///< of one that cannot be read
  };
  Publishers publishers(const std::string& topic) const;
  bool can_read(const bus::TopicWriter& writer) const;
  bus::RawHandlers handlers(const bus::RawTopic& topic);
  std::string without_publisher() const;

  const std::uint32_t domain_;
  const bool loopback_only_;
  concurrency::BoundedQueue<RecordedMessage> queue_;
  std::shared_ptr<bus::RawBus> bus_;
  std::atomic<bool> wants_transforms_{true};
  /// By the ROS names of the topics that are read: the types that can be read, plain_type().
  const std::map<std::string, std::set<std::string>> types_;
  bus::TopicFollower follower_;
};

}  // namespace rtd::camera
