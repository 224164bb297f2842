// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/service/monotonic_clock.hpp"
#include "services/camera/ros2/ros2_device.hpp"

namespace rtd::camera {

/// The topics of a ROS 2 camera driver, over a connection of its own. Each topic is read as its writers offer it
/// (TopicListener): best effort where a writer offers no more (ROS 2's sensor data profile).
class Ros2Feed final : public LiveFeed {
 public:
  /// Throws BusError when the bus refuses.
  Ros2Feed(const bus::BusOptions& options, const LiveTopics& topics);
  ~Ros2Feed() override;

  std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) override { return queue_.pop_for(timeout); }
  void clear() override;
  void end_transforms() override { wants_transforms_ = false; }
  std::uint64_t dropped() const override { return queue_.dropped(); }
  std::int64_t now_ns() const override { return service::monotonic_ns(); }
  std::string state_of(const std::string& topic) const override;
  bool is_published(const std::string& topic) const override { return publishers(topic).readable > 0; }

 private:
  struct Subscription {
    std::string topic;            ///< ROS name
    std::set<std::string> types;  ///< that can be read, plain_type()
    std::unique_ptr<bus::TopicListener> listener;
  };

  struct Publishers {
    int readable = 0;
    std::string other_type;  ///< of one that cannot be read
  };
  Publishers publishers(const std::string& topic) const;
  void follow(const bus::TopicWriter& writer, bus::WriterChange change);
  void subscribe(Subscription& subscription, const bus::TopicWriter& writer);
  bus::RawHandlers handlers(const Subscription& subscription, const bus::TopicWriter& writer);
  std::string without_publisher() const;

  const std::uint32_t domain_;
  const bool loopback_only_;
  concurrency::BoundedQueue<RecordedMessage> queue_;
  std::shared_ptr<bus::RawBus> bus_;
  std::atomic<bool> wants_transforms_{true};
  std::vector<Subscription> subscriptions_;  ///< only the thread of the bus's watcher changes listeners
};

}  // namespace rtd::camera
