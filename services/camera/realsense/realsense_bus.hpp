// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/bus/topic_follower.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/camera/realsense/realsense_protocol.hpp"

/// What RealSense cameras on DDS announce and send. Everything here belongs to one thread.
namespace rtd::camera::realsense {

/// What the bus brings: a sample, or without bytes the news that writers or readers have come or gone.
struct Event {
  std::string topic;
  bus::WriterId writer{};
  std::shared_ptr<const bus::ByteBlock> bytes;
  ros::Bytes cdr() const { return {reinterpret_cast<const std::uint8_t*>(bytes->view().data()), bytes->view().size()}; }
};

/// Subscriptions to topics whose writers come and go.
class Subscriptions {
 public:
  using Clock = std::chrono::steady_clock;

  /// Joins the domain. Throws BusError, also in a build without Fast DDS.
  explicit Subscriptions(const bus::BusOptions& options);

  /// From now on, or no longer.
  void read(const std::string& topic, bool wanted);
  bool published(const std::string& topic) const;
  bool writes(const std::string& topic, const bus::WriterId& writer) const;
  std::unique_ptr<bus::RawWriter> writer(const bus::RawTopic& topic);
  /// The next event; empty when none came in time.
  std::optional<Event> next(Clock::time_point until);

 private:
  bus::RawHandlers handlers(const std::string& topic);

  concurrency::BoundedQueue<Event> queue_;
  std::shared_ptr<bus::RawBus> bus_;
  mutable std::mutex mutex_;
  bus::TopicFollower follower_;  ///< under the lock
};

/// The devices that announce themselves, each with its description as far as it has come.
class Devices {
 public:
  using Clock = Subscriptions::Clock;
  struct Device {
    DeviceInfo info;
    bus::WriterId announcer{};
    Description description;
    std::optional<nlohmann::json> reply;  ///< to the last open-streams
  };

  /// Throws as Subscriptions.
  explicit Devices(const bus::BusOptions& options);

  Subscriptions& subscriptions() { return subscriptions_; }
  std::map<std::string, Device>& all() { return devices_; }  ///< by topic root

  /// The next sample of a topic that is not the devices' own.
  std::optional<Event> next(Clock::time_point until);
  /// Waits until the condition holds.
  template <class Condition>
  bool wait(std::chrono::milliseconds time, Condition&& holds) {
    const Clock::time_point until = Clock::now() + time;
    while (!holds()) {
      const std::optional<Event> event = subscriptions_.next(until);
      if (!event) return holds();
      take(*event);
    }
    return true;
  }

 private:
  bool take(const Event& event);
  void take_info(const Event& event);
  void forget(const bus::WriterId& announcer);
  void forget_silent();

  Subscriptions subscriptions_;
  std::map<std::string, Device> devices_;
};

}  // namespace rtd::camera::realsense
