// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/live_camera.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "common/bus/host/host_checks.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topic_follower.hpp"
#include "common/bus/topics.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/ros2/names.hpp"
#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/stop_token.hpp"
#include "services/camera/core/live/device_source.hpp"
#include "services/camera/openni2/oni_file.hpp"
#include "services/camera/openni2/openni2_device.hpp"
#include "services/camera/realsense/realsense_device.hpp"
#include "services/camera/ros2/ros2_device.hpp"

namespace rtd::camera {
namespace {

/// Lets the images of the publisher pass that came first, until it is gone or silent for a second. Two cameras may send
/// on one topic, also from one process, which SourceGate takes for one source. Thread-safe.
class FirstPublisher {
 public:
  bool accepts(const bus::WriterId& writer) {
    constexpr std::int64_t kSilentNs = 1'000'000'000;
    const std::int64_t now_ns = service::monotonic_ns();
    const std::lock_guard lock(mutex_);
    if (!followed_ || now_ns - received_ns_ > kSilentNs) followed_ = writer;
    const bool first = followed_ == writer;
    if (first)
      received_ns_ = now_ns;
    else
      ++refused_;
    return first;
  }
  void forget(const bus::WriterId& writer) {
    const std::lock_guard lock(mutex_);
    if (followed_ == writer) followed_.reset();
  }
  std::uint64_t refused() const {
    const std::lock_guard lock(mutex_);
    return refused_;
  }

 private:
  mutable std::mutex mutex_;
  std::optional<bus::WriterId> followed_;
  std::int64_t received_ns_ = 0;
  std::uint64_t refused_ = 0;
};

/// The topics of a ROS 2 camera driver, over its own connection. Each topic is read as its writers offer it
/// (TopicFollower): best effort where a writer offers no more (ROS 2's sensor data profile).
class Ros2Feed final : public LiveFeed {
 public:
  /// Throws BusError when the bus refuses.
  Ros2Feed(const bus::BusOptions& options, const LiveTopics& topics);

  std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) override;
  void clear() override;
  void end_transforms() override { wants_transforms_ = false; }
  std::uint64_t dropped() const override { return queue_.dropped(); }
  std::uint64_t of_others() const override { return color_publisher_.refused(); }
  std::int64_t now_ns() const override { return service::monotonic_ns(); }
  std::string state_of(const std::string& topic) const override;
  bool is_published(const std::string& topic) const override { return publishers(topic).readable > 0; }

 private:
  struct Publishers {
    int readable = 0;
    std::string other_type;  ///< of one that cannot be read
  };
  void connect();
  bool needs_udp() const;
  Publishers publishers(const std::string& topic) const;
  bool can_read(const bus::TopicWriter& writer) const;
  bus::RawHandlers handlers(const bus::RawTopic& topic);
  std::string without_publisher() const;

  const bus::BusOptions options_;
  FirstPublisher color_publisher_, depth_publisher_;
  concurrency::BoundedQueue<RecordedMessage> queue_;
  std::shared_ptr<bus::RawBus> bus_;
  bool in_shared_memory_ = true;  ///< no program of another user was there when it was connected
  std::int64_t silent_since_ns_ = 0;
  std::atomic<bool> wants_transforms_{true};
  const std::string color_topic_, depth_topic_;
  /// By the ROS names of the topics that are read: the types that can be read, plain_type().
  const std::map<std::string, std::set<std::string>> types_;
  std::optional<bus::TopicFollower> follower_;
};

constexpr std::size_t kQueue = 32;                 // messages of four topics: a quarter of a second
constexpr int kReaderDepth = 8;                    // images that may wait for the reader's thread
constexpr std::size_t kLargestImage = 32U << 20U;  // bytes; 3840x2160 in colour has 25 MB
constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";
constexpr const char* kInfo = "sensor_msgs/CameraInfo";
constexpr const char* kTransform = "tf2_msgs/TFMessage";

/// rtd's own images, those of any robot, come from no camera.
bool is_ours(const std::string& dds_topic) {
  using namespace bus::topics;
  const std::string topic = bus::split_robot(dds_topic).topic;
  return topic == kColorJpeg.name || topic == kPersonMasks.name || topic == kDynamicMask.name ||
         topic == kDepthJpeg.name;
}

std::string plain_dds_type(const bus::RawTopic& topic) {
  return plain_type(ros2::ros_type(topic.type));
}

Ros2Feed::Ros2Feed(const bus::BusOptions& options, const LiveTopics& topics)
    : options_(options),
      queue_(kQueue, concurrency::Overflow::kDropOldest),
      color_topic_(topics.color),
      depth_topic_(topics.depth),
      types_{
          {topics.color, {kImage, kCompressed}}, {topics.depth, {kImage, kCompressed}}, {topics.info, {kInfo}},
          {topics.depth_info, {kInfo}},          {kLastingTransforms, {kTransform}},    {kTransforms, {kTransform}}} {
  connect();
}

void Ros2Feed::connect() {
  in_shared_memory_ = bus::why_not_shared_memory(options_, bus::read_host_limits()).empty();
  std::shared_ptr<bus::RawBus> bus = bus::connect_raw(options_);
  follower_.reset();
  bus_ = std::move(bus);
  silent_since_ns_ = now_ns();
  follower_.emplace(*bus_,
                    bus::TopicFollower::Options{
                        .wants = [this](const bus::TopicWriter& writer) { return can_read(writer); },
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
                        .reader = {.transient_local = true, .depth = kReaderDepth, .largest_sample = kLargestImage}});
}

/// Waits as LiveFeed says, and comes back over UDP where a driver of another user started later than this camera.
std::optional<RecordedMessage> Ros2Feed::next(std::chrono::milliseconds timeout) {
  std::optional<RecordedMessage> message = queue_.pop_for(timeout);
  if (message) {
    silent_since_ns_ = now_ns();
  } else if (needs_udp()) {
    SPDLOG_WARN("event=camera_over_udp cause=\"{}\"", bus::why_not_shared_memory(options_, bus::read_host_limits()));
    try {
      connect();
    } catch (const bus::BusError& error) {
      SPDLOG_WARN("event=not_connected_again cause=\"{}\"", error.what());
    }
  }
  return message;
}

bool Ros2Feed::needs_udp() const {
  constexpr std::int64_t kSilentNs = 2'000'000'000;
  return in_shared_memory_ && now_ns() - silent_since_ns_ > kSilentNs && is_published(color_topic_) &&
         !bus::why_not_shared_memory(options_, bus::read_host_limits()).empty();
}

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
  const std::string read = ros2::ros_topic(topic.name);
  FirstPublisher* const first = read == color_topic_   ? &color_publisher_
                                : read == depth_topic_ ? &depth_publisher_
                                                       : nullptr;
  handlers.status.on_writer = [first](const bus::WriterId& writer, bool matched) {
    if (first != nullptr && !matched) first->forget(writer);
  };
  handlers.on_sample = [this, name = read, type = plain_dds_type(topic), first](const bus::RawSample& sample) {
    if (type == kTransform && !wants_transforms_) return;
    if (first != nullptr && !first->accepts(sample.writer)) return;
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
  if (readable > 0) {
    const std::string closed = bus::why_not_shared_memory(options_, bus::read_host_limits());
    return fmt::format("{} of its type, but no message arrives{}{}", readable == 1 ? "one publisher" : "publishers",
                       closed.empty() ? "" : "; ", closed);
  }
  if (!other_type.empty()) return fmt::format("it is published as {}, which is not read here", other_type);
  return without_publisher();
}

std::string Ros2Feed::without_publisher() const {
  std::set<std::string> images;
  for (const bus::TopicWriter& writer : bus_->writers()) {
    const std::string type = plain_dds_type(writer.topic), &name = writer.topic.name;
    if ((type == kImage || type == kCompressed) && !is_ours(name)) images.insert(ros2::ros_topic(name));
  }
  const std::string where = fmt::format("it has no publisher in DDS domain {}", options_.domain);
  if (!images.empty()) return fmt::format("{}; images are published on {}", where, fmt::join(images, ", "));
  return fmt::format("{}{}, and neither has any image topic; does the driver run, and in this ROS_DOMAIN_ID?", where,
                     options_.network.loopback_only ? " on this host (--profile lan: also on the network)" : "");
}

/// The time of this host.
class HostClock final : public DeviceClock {
 public:
  std::int64_t now_ns() const override { return service::monotonic_ns(); }
  void wait(std::chrono::milliseconds time) override { stop_.wait_for(time); }
  void close() override { stop_.request_stop(); }
  bool closed() const override { return stop_.stop_requested(); }

 private:
  service::StopToken stop_;
};

/// A file is checked before OpenNI2's library reads it.
std::unique_ptr<LiveDevice> make_checked_openni2_device(const DeviceUri& uri) {
  try {
    require_oni_file(uri.device);
  } catch (const OniFileError& error) {
    throw SourceError(error.what());
  }
  return make_openni2_device(uri);
}

}  // namespace

std::unique_ptr<FrameSource> make_live_source(const std::string& uri, const bus::BusOptions& bus,
                                              std::int64_t open_timeout_ns,
                                              std::function<void(const std::string&)> on_wait) {
  DeviceOptions options{{}, open_timeout_ns, service::realtime_ns() - service::monotonic_ns(), std::move(on_wait)};
  std::unique_ptr<LiveDevice> device;
  if (is_device(uri)) {
    options.uri = parse_device_uri(uri);
    device = options.uri.scheme == "openni2" ? make_checked_openni2_device(options.uri)
                                             : make_realsense_device(bus, options.uri.device);
  } else {
    const LiveOptions ros2 = parse_live_options(uri);
    options.uri.text = uri;
    options.uri.calibration_file = ros2.calibration_file;
    options.uri.tolerance_ns = ros2.tolerance_ns;
    device = std::make_unique<Ros2Device>(uri, std::make_unique<Ros2Feed>(bus, ros2.topics), ros2);
  }
  return std::make_unique<DeviceSource>(std::move(device), std::make_unique<HostClock>(), std::move(options));
}

}  // namespace rtd::camera
