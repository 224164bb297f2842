// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/ros2/ros2_feed.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/bus/topics.hpp"
#include "common/ros2/names.hpp"
#include "common/service/log.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kQueue = 32;  // messages of four topics: a quarter of a second
constexpr int kReaderDepth = 8;     // images that may wait for the reader's thread
constexpr std::size_t kLargestImage = 32U << 20U;  // bytes; 3840x2160 in colour has 25 MB
constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";
constexpr const char* kInfo = "sensor_msgs/CameraInfo";
constexpr const char* kTransform = "tf2_msgs/TFMessage";

/// rtd's own images come from no camera.
bool is_ours(const std::string& dds_topic) {
  using namespace bus::topics;
  return dds_topic == kColorJpeg.name || dds_topic == kPersonMasks.name || dds_topic == kDynamicMask.name;
}

std::string plain_dds_type(const bus::RawTopic& topic) {
  return plain_type(ros2::ros_type(topic.type));
}

}  // namespace

Ros2Feed::Ros2Feed(const bus::BusOptions& options, const LiveTopics& topics)
    : domain_(options.domain),
      loopback_only_(options.network.loopback_only),
      queue_(kQueue, concurrency::Overflow::kDropOldest),
      bus_(bus::connect_raw(options)),
      types_{{topics.color, {kImage, kCompressed}}, {topics.depth, {kImage, kCompressed}}, {topics.info, {kInfo}},
             {topics.depth_info, {kInfo}},          {kLastingTransforms, {kTransform}},    {kTransforms, {kTransform}}},
      follower_(*bus_, {.wants = [this](const bus::TopicWriter& writer) { return can_read(writer); },
                        .handlers = [this](const bus::RawTopic& topic) { return handlers(topic); },
                        .on_read =
                            [](const bus::TopicWriter& writer, const bus::RawReaderOptions& reader) {
                              SPDLOG_INFO("event=camera_topic topic={} type={} reliable={} latched={}",
                                          ros2::ros_topic(writer.topic.name), plain_dds_type(writer.topic),
                                          reader.reliable, reader.transient_local);
                            },
                        .on_refused =
                            [](const bus::TopicWriter& writer, const bus::BusError& error) {
                              SPDLOG_WARN("event=topic_refused topic={} cause=\"{}\"",
                                          ros2::ros_topic(writer.topic.name), error.what());
                            },
                        .reader = {.transient_local = true, .depth = kReaderDepth, .largest_sample = kLargestImage}}) {}

void Ros2Feed::clear() {
  while (queue_.pop_for(std::chrono::milliseconds(0))) {
  }
}

bool Ros2Feed::can_read(const bus::TopicWriter& writer) const {
  const auto read = types_.find(ros2::ros_topic(writer.topic.name));
  return read != types_.end() && read->second.contains(plain_dds_type(writer.topic));
}

bus::RawHandlers Ros2Feed::handlers(const bus::RawTopic& topic) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, name = ros2::ros_topic(topic.name),
                        type = plain_dds_type(topic)](const bus::RawSample& sample) {
    if (type == kTransform && !wants_transforms_) return;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
    queue_.push({name, now_ns(), ros::Wire::kCdr, {bytes, bytes + sample.cdr().size()}, type});
  };
  return handlers;
}

Ros2Feed::Publishers Ros2Feed::publishers(const std::string& topic) const {
  Publishers found;
  for (const bus::TopicWriter& writer : bus_->writers()) {
    if (ros2::ros_topic(writer.topic.name) != topic) continue;
    if (can_read(writer)) {
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
    const std::string type = plain_dds_type(writer.topic);
    if (is_ours(writer.topic.name)) continue;
    if (type == kImage || type == kCompressed) images.insert(ros2::ros_topic(writer.topic.name));
  }
  const std::string where = fmt::format("it has no publisher in DDS domain {}", domain_);
  if (!images.empty()) return fmt::format("{}; images are published on {}", where, fmt::join(images, ", "));
  return fmt::format("{}{}, and neither has any image topic; does the driver run, and in this ROS_DOMAIN_ID?", where,
                     loopback_only_ ? " on this host (--profile lan: also on the network)" : "");
}

}  // namespace rtd::camera
