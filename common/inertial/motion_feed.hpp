// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/topic_follower.hpp"
#include "common/inertial/preintegration.hpp"
#include "common/msg/imu.hpp"

namespace rtd::inertial {

/// The message of a driver as a core takes it. Whether the values can be is the core's to say.
ImuSample to_sample(const msg::Imu& imu);

/// ROS names of the topics of a service; empty: none.
struct MotionFeedTopics {
  std::string imu, wheels;
  std::string section;  ///< of the configuration that names them: "slam"
};

/// Reads `sensor_msgs/Imu` and `nav_msgs/Odometry` on its own connection, as their writers offer them: best effort
/// where a driver offers no more. Samples wait until the frame that needs them; the oldest go when too many do.
class MotionFeed {
 public:
  /// Throws BusError when the bus refuses.
  MotionFeed(const bus::BusOptions& options, const MotionFeedTopics& topics);

  /// Waits until every topic that is published has a sample of this stamp or later, but no longer than two seconds: a
  /// busy host delays samples by less. Once it has waited in vain, it waits no more until samples come again.
  void await(std::int64_t stamp_ns);
  /// What has come since the last call, in order of arrival.
  std::deque<ImuSample> take_imu();
  std::deque<msg::Odometry> take_wheels();

  struct Counters {
    std::uint64_t received = 0, undecodable = 0, overflowed = 0;
  };
  Counters imu_counters() const;
  Counters wheel_counters() const;
  /// What is wrong with a topic, with the fix; empty when samples come.
  std::string trouble() const;

 private:
  template <class Sample>
  struct Subscription {
    std::string topic;  ///< ROS name; empty: not read
    std::string dds_type;
    std::deque<Sample> waiting;
    std::int64_t newest_ns = 0;
    bool silent = false;  ///< waited for in vain
    Counters counters;
    std::string other_type;  ///< of a writer that cannot be read
  };

  bool wants(const bus::TopicWriter& writer);
  /// Whether it is a writer of this topic and type. Notes another type.
  template <class Sample>
  bool takes(Subscription<Sample>& subscription, const bus::TopicWriter& writer);
  bus::RawHandlers handlers(const bus::RawTopic& topic);
  template <class Message, class Sample>
  void receive(Subscription<Sample>& subscription, const bus::RawSample& sample);

  const std::string section_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  Subscription<ImuSample> imu_;
  Subscription<msg::Odometry> wheels_;
  std::shared_ptr<bus::RawBus> bus_;
  bus::TopicFollower follower_;
};

}  // namespace rtd::inertial
