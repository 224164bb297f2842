// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/motion_feed.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/msg/imu.hpp"
#include "common/ros2/names.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/log.hpp"
#include "services/slam/motion_samples.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kMostWaiting = 4096;
constexpr int kReaderDepth = 256;  // samples that may wait for the reader's thread: more than a second

}  // namespace

MotionFeed::MotionFeed(const bus::BusOptions& options, const std::string& imu_topic, const std::string& wheel_topic)
    : imu_{.topic = imu_topic, .dds_type = msg::kImuDdsType},
      wheels_{.topic = wheel_topic, .dds_type = msg::kOdometryDdsType},
      bus_(bus::connect_raw(options)) {
  bus_->watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { take_note(writer, change); });
}

MotionFeed::~MotionFeed() {
  bus_->watch(nullptr);
  imu_.listener.reset();
  wheels_.listener.reset();
}

void MotionFeed::take_note(const bus::TopicWriter& writer, bus::WriterChange change) {
  if (change == bus::WriterChange::kGone) return;
  const std::string topic = ros2::ros_topic(writer.topic.name);
  if (topic == imu_.topic) subscribe<msg::Imu>(imu_, writer);
  if (topic == wheels_.topic) subscribe<msg::Odometry>(wheels_, writer);
}

template <class Message, class Sample>
void MotionFeed::subscribe(Line<Sample>& line, const bus::TopicWriter& writer) {
  if (writer.topic.type != line.dds_type) {
    const std::lock_guard lock(mutex_);
    line.other_type = ros2::ros_type(writer.topic.type);
    return;
  }
  try {
    if (line.listener == nullptr) {
      bus::RawHandlers handlers;
      handlers.on_sample = [this, &line](const bus::RawSample& sample) { receive<Message>(line, sample); };
      line.listener = std::make_unique<bus::TopicListener>(*bus_, std::move(handlers), false, kReaderDepth);
    }
    line.listener->add(writer);
    SPDLOG_INFO("event=motion_topic topic={} type={} reliable={}", line.topic, ros2::ros_type(line.dds_type),
                line.listener->reliable());
  } catch (const bus::BusError& error) {
    SPDLOG_WARN("event=topic_refused topic={} cause=\"{}\"", line.topic, error.what());
  }
}

template <class Message, class Sample>
void MotionFeed::receive(Line<Sample>& line, const bus::RawSample& sample) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
  const std::lock_guard lock(mutex_);
  ++line.counters.received;
  try {
    line.waiting.push_back(to_sample(ros::decode<Message>(ros::Wire::kCdr, {bytes, sample.cdr().size()})));
  } catch (const ros::WireError&) {
    ++line.counters.undecodable;
    return;
  }
  line.newest_ns = line.waiting.back().stamp_ns;
  line.silent = false;
  if (line.waiting.size() > kMostWaiting) {
    line.waiting.pop_front();
    ++line.counters.overflowed;
  }
  arrived_.notify_all();
}

void MotionFeed::await(std::int64_t stamp_ns, std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  const auto missing = [stamp_ns](const auto& line) {
    return !line.silent && line.counters.received > 0 && line.newest_ns < stamp_ns;
  };
  if (arrived_.wait_for(lock, most, [&] { return !missing(imu_) && !missing(wheels_); })) return;
  imu_.silent = imu_.silent || missing(imu_);
  wheels_.silent = wheels_.silent || missing(wheels_);
}

void MotionFeed::drain(SlamSystem& slam) {
  const std::lock_guard lock(mutex_);
  for (const ImuSample& sample : std::exchange(imu_.waiting, {})) slam.add(sample);
  for (const WheelSample& sample : std::exchange(wheels_.waiting, {})) slam.add(sample);
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
  const auto of = [](const auto& line, const char* key) -> std::string {
    if (line.topic.empty() || line.counters.received > line.counters.undecodable) return {};
    if (line.counters.undecodable > 0)
      return fmt::format("no message on {} can be decoded as {}", line.topic, ros2::ros_type(line.dds_type));
    if (!line.other_type.empty())
      return fmt::format("{} is published as {}, not {}; check {}", line.topic, line.other_type,
                         ros2::ros_type(line.dds_type), key);
    return fmt::format("no message on {}: does its driver run in this domain? ({})", line.topic, key);
  };
  const std::string imu = of(imu_, "slam.imu.topic");
  return imu.empty() ? of(wheels_, "slam.wheel.topic") : imu;
}

}  // namespace rtd::slam
