// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/ros2/ros2_feed.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "common/bus/topics.hpp"
#include "common/ros2/names.hpp"
#include "common/service/log.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kQueue = 32;  // messages of four topics: a quarter of a second
constexpr int kReaderDepth = 8;     // images that may wait for the reader's thread
constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";
constexpr const char* kInfo = "sensor_msgs/CameraInfo";
constexpr const char* kTransform = "tf2_msgs/TFMessage";

/// rtd's own images come from no camera.
bool is_ours(const std::string& dds_topic) {
  return dds_topic == bus::topics::kColorJpeg.name || dds_topic == bus::topics::kDynamicMask.name;
}

std::string plain_dds_type(const bus::TopicWriter& writer) {
  return plain_type(ros2::ros_type(writer.topic.type));
}

}  // namespace

Ros2Feed::Ros2Feed(const bus::BusOptions& options, const LiveTopics& topics)
    : domain_(options.domain),
      loopback_only_(options.network.loopback_only),
      queue_(kQueue, concurrency::Overflow::kDropOldest),
      bus_(bus::connect_raw(options)) {
  const std::pair<std::string, std::set<std::string>> read[] = {
      {topics.color, {kImage, kCompressed}}, {topics.depth, {kImage, kCompressed}}, {topics.info, {kInfo}},
      {topics.depth_info, {kInfo}},          {kLastingTransforms, {kTransform}},    {kTransforms, {kTransform}}};
  for (const auto& [topic, types] : read) {
    const bool doubled = std::ranges::any_of(
        subscriptions_, [&](const Subscription& subscription) { return subscription.topic == topic; });
    if (!doubled) subscriptions_.push_back({topic, types, nullptr});
  }
  bus_->watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { follow(writer, change); });
}

Ros2Feed::~Ros2Feed() {
  bus_->watch(nullptr);
  for (Subscription& subscription : subscriptions_) subscription.listener.reset();
}

void Ros2Feed::clear() {
  while (queue_.pop_for(std::chrono::milliseconds(0))) {
  }
}

void Ros2Feed::follow(const bus::TopicWriter& writer, bus::WriterChange change) {
  if (change == bus::WriterChange::kGone) return;
  const std::string topic = ros2::ros_topic(writer.topic.name);
  for (Subscription& subscription : subscriptions_) {
    if (subscription.topic != topic || !subscription.types.contains(plain_dds_type(writer))) continue;
    try {
      subscribe(subscription, writer);
    } catch (const bus::BusError& error) {
      SPDLOG_WARN("event=topic_refused topic={} cause=\"{}\"", topic, error.what());
    }
  }
}

void Ros2Feed::subscribe(Subscription& subscription, const bus::TopicWriter& writer) {
  if (subscription.listener == nullptr) {
    subscription.listener =
        std::make_unique<bus::TopicListener>(*bus_, handlers(subscription, writer), false, kReaderDepth);
  }
  subscription.listener->add(writer);
  SPDLOG_INFO("event=camera_topic topic={} type={} reliable={} latched={}", subscription.topic, plain_dds_type(writer),
              subscription.listener->reliable(), subscription.listener->latched());
}

bus::RawHandlers Ros2Feed::handlers(const Subscription& subscription, const bus::TopicWriter& writer) {
  bus::RawHandlers handlers;
  const bool is_transform = subscription.types.contains(kTransform);
  handlers.on_sample = [=, this, topic = subscription.topic,
                        type = plain_dds_type(writer)](const bus::RawSample& sample) {
    if (is_transform && !wants_transforms_) return;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
    RecordedMessage message{topic, now_ns(), ros::Wire::kCdr, {bytes, bytes + sample.cdr().size()}, type};
    queue_.push(std::move(message));
  };
  return handlers;
}

Ros2Feed::Publishers Ros2Feed::publishers(const std::string& topic) const {
  Publishers found;
  const auto subscription =
      std::ranges::find_if(subscriptions_, [&](const Subscription& one) { return one.topic == topic; });
  for (const bus::TopicWriter& writer : bus_->writers()) {
    if (ros2::ros_topic(writer.topic.name) != topic) continue;
    if (subscription != subscriptions_.end() && subscription->types.contains(plain_dds_type(writer))) {
      ++found.readable;
    } else {
      found.other_type = ros2::ros_type(writer.topic.type);
    }
  }
  return found;
}

std::string Ros2Feed::state_of(const std::string& topic) const {
  const auto [readable, other_type] = publishers(topic);
  if (readable > 0)
    return fmt::format("{} of its type, but no message arrives", readable == 1 ? "one publisher" : "publishers");
  if (!other_type.empty()) return fmt::format("it is published as {}, which is not read here", other_type);
  return without_publisher();
}

std::string Ros2Feed::without_publisher() const {
  std::set<std::string> images;
  for (const bus::TopicWriter& writer : bus_->writers()) {
    const std::string type = plain_dds_type(writer);
    if (is_ours(writer.topic.name)) continue;
    if (type == kImage || type == kCompressed) images.insert(ros2::ros_topic(writer.topic.name));
  }
  const std::string where = fmt::format("it has no publisher in DDS domain {}", domain_);
  if (!images.empty()) return fmt::format("{}; images are published on {}", where, fmt::join(images, ", "));
  return fmt::format("{}{}, and neither has any image topic; does the driver run, and in this ROS_DOMAIN_ID?", where,
                     loopback_only_ ? " on this host (--profile lan: also on the network)" : "");
}

}  // namespace rtd::camera
