// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/inertial/motion_feed.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/ros2/names.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/log.hpp"

namespace rtd::inertial {
namespace {

Eigen::Vector3d to_eigen(const msg::Vector3& v) {
  return {v.x, v.y, v.z};
}

/// A topic is read as it is, or as the core takes it.
const msg::Odometry& to_sample(const msg::Odometry& odometry) {
  return odometry;
}

constexpr std::size_t kMaxWaiting = 4096;
constexpr int kReaderDepth = 256;  // samples that may wait for the reader's thread: more than a second

}  // namespace

ImuSample to_sample(const msg::Imu& imu) {
  return {msg::to_ns(imu.header.stamp), to_eigen(imu.angular_velocity), to_eigen(imu.linear_acceleration)};
}

MotionFeed::MotionFeed(const bus::BusOptions& options, const MotionFeedTopics& topics)
    : section_(topics.section),
      imu_{.topic = topics.imu, .dds_type = msg::kImuDdsType},
      wheels_{.topic = topics.wheels, .dds_type = msg::kOdometryDdsType},
      bus_(bus::connect_raw(options)),
      follower_(*bus_, {.wants = [this](const bus::TopicWriter& writer) { return wants(writer); },
                        .handlers = [this](const bus::RawTopic& topic) { return handlers(topic); },
                        .on_read =
                            [](const bus::TopicWriter& writer, const bus::RawReaderOptions& reader) {
                              SPDLOG_INFO("event=motion_topic topic={} type={} reliable={}",
                                          ros2::ros_topic(writer.topic.name), ros2::ros_type(writer.topic.type),
                                          reader.reliable);
                            },
                        .on_refused =
                            [](const bus::TopicWriter& writer, const bus::BusError& error) {
                              SPDLOG_WARN("event=topic_refused topic={} cause=\"{}\"",
                                          ros2::ros_topic(writer.topic.name), error.what());
                            },
                        .reader = {.transient_local = true, .depth = kReaderDepth}}) {}

bool MotionFeed::wants(const bus::TopicWriter& writer) {
  const bool imu = takes(imu_, writer), wheels = takes(wheels_, writer);
  return imu || wheels;
}

template <class Sample>
bool MotionFeed::takes(Subscription<Sample>& subscription, const bus::TopicWriter& writer) {
  if (ros2::ros_topic(writer.topic.name) != subscription.topic) return false;
  if (writer.topic.type == subscription.dds_type) return true;
  const std::lock_guard lock(mutex_);
  subscription.other_type = ros2::ros_type(writer.topic.type);
  return false;
}

bus::RawHandlers MotionFeed::handlers(const bus::RawTopic& topic) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, is_imu = topic.type == imu_.dds_type](const bus::RawSample& sample) {
    is_imu ? receive<msg::Imu>(imu_, sample) : receive<msg::Odometry>(wheels_, sample);
  };
  return handlers;
}

template <class Message, class Sample>
void MotionFeed::receive(Subscription<Sample>& subscription, const bus::RawSample& sample) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
  const std::lock_guard lock(mutex_);
  ++subscription.counters.received;
  try {
    const auto message = ros::decode<Message>(ros::Wire::kCdr, {bytes, sample.cdr().size()});
    subscription.newest_ns = msg::to_ns(message.header.stamp);
    subscription.waiting.push_back(to_sample(message));
  } catch (const ros::WireError&) {
    ++subscription.counters.undecodable;
    return;
  }
  subscription.silent = false;
  if (subscription.waiting.size() > kMaxWaiting) {
    subscription.waiting.pop_front();
    ++subscription.counters.overflowed;
  }
  arrived_.notify_all();
}

void MotionFeed::await(std::int64_t stamp_ns) {
  constexpr std::chrono::seconds kMost{2};
  std::unique_lock lock(mutex_);
  const auto missing = [stamp_ns](const auto& subscription) {
    return !subscription.silent && subscription.counters.received > 0 && subscription.newest_ns < stamp_ns;
  };
  if (arrived_.wait_for(lock, kMost, [&] { return !missing(imu_) && !missing(wheels_); })) return;
  imu_.silent = imu_.silent || missing(imu_);
  wheels_.silent = wheels_.silent || missing(wheels_);
}

std::deque<ImuSample> MotionFeed::take_imu() {
  const std::lock_guard lock(mutex_);
  return std::exchange(imu_.waiting, {});
}

std::deque<msg::Odometry> MotionFeed::take_wheels() {
  const std::lock_guard lock(mutex_);
  return std::exchange(wheels_.waiting, {});
}

MotionFeed::Counters MotionFeed::imu_counters() const {
  const std::lock_guard lock(mutex_);
  return imu_.counters;
}

MotionFeed::Counters MotionFeed::wheel_counters() const {
  const std::lock_guard lock(mutex_);
  return wheels_.counters;
}

std::string MotionFeed::trouble() const {
  const std::lock_guard lock(mutex_);
  const auto of = [this](const auto& subscription, const char* of_section) -> std::string {
    const std::string key = section_ + of_section;
    if (subscription.topic.empty() || subscription.counters.received > subscription.counters.undecodable) return {};
    if (subscription.counters.undecodable > 0)
      return fmt::format("no message on {} can be decoded as {}", subscription.topic,
                         ros2::ros_type(subscription.dds_type));
    if (!subscription.other_type.empty())
      return fmt::format("{} is published as {}, not {}; check {}", subscription.topic, subscription.other_type,
                         ros2::ros_type(subscription.dds_type), key);
    return fmt::format("no message on {}: does its driver run in this domain? ({})", subscription.topic, key);
  };
  const std::string imu = of(imu_, ".imu.topic");
  return imu.empty() ? of(wheels_, ".wheel.topic") : imu;
}

}  // namespace rtd::inertial
