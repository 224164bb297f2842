// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/realsense/realsense_bus.hpp"

#include <algorithm>
#include <utility>

#include "common/service/log.hpp"

namespace rtd::camera::realsense {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kEvents = 64;
constexpr int kStreamDepth = 8;
constexpr std::size_t kLargestImage = 32U << 20U;  // bytes

/// Cyclone DDS refuses topics with '-' in their names, and these cameras use Fast DDS themselves.
std::shared_ptr<bus::RawBus> connect_to_cameras(bus::BusOptions options) {
  constexpr const char* kVendor = "fastdds";
  const std::vector<std::string> vendors = bus::available_vendors();
  if (std::ranges::find(vendors, kVendor) == vendors.end()) {
    throw bus::BusError("realsense-dds: needs Fast DDS, which this build does not have: configure and build with it");
  }
  options.vendor = kVendor;
  return bus::connect_raw(options);
}

std::string notifications_of(const std::string& root) {
  return root + "/notification";
}

void take_notification(Devices::Device& device, const Event& event) {
  nlohmann::json message = read_flexible(event.cdr());
  device.description.take(message);
  if (message.is_object() && message.value("id", "") == "open-streams") device.reply = std::move(message);
}

}  // namespace

Subscriptions::Subscriptions(const bus::BusOptions& options)
    : queue_(kEvents, concurrency::Overflow::kDropOldest),
      bus_(connect_to_cameras(options)),
      follower_(*bus_, {.handlers = [this](const bus::RawTopic& topic) { return handlers(topic.name); },
                        .on_refused =
                            [](const bus::TopicWriter& writer, const bus::BusError& error) {
                              SPDLOG_WARN("event=topic_refused topic={} cause=\"{}\"", writer.topic.name, error.what());
                            },
                        .run =
                            [this](const std::function<void()>& change) {
                              {
                                const std::lock_guard lock(mutex_);
                                change();
                              }
                              queue_.push(Event{});
                            },
                        .on_demand = true,
                        .reader = {.transient_local = true, .depth = kStreamDepth, .largest_sample = kLargestImage}}) {}

void Subscriptions::read(const std::string& topic, bool wanted) {
  const std::lock_guard lock(mutex_);
  follower_.read(topic, wanted);
}

bool Subscriptions::published(const std::string& topic) const {
  const std::lock_guard lock(mutex_);
  return !follower_.writers(topic).empty();
}

bool Subscriptions::writes(const std::string& topic, const bus::WriterId& writer) const {
  const std::lock_guard lock(mutex_);
  return follower_.writers(topic).contains(writer);
}

bus::RawHandlers Subscriptions::handlers(const std::string& topic) {
  bus::RawHandlers handlers;
  handlers.on_sample = [this, topic](const bus::RawSample& sample) {
    queue_.push(Event{topic, sample.writer, sample.bytes});
  };
  return handlers;
}

std::unique_ptr<bus::RawWriter> Subscriptions::writer(const bus::RawTopic& topic) {
  bus::StatusCallbacks callbacks;
  callbacks.on_matched = [this](int) { queue_.push(Event{}); };
  return bus_->writer(topic, {}, std::move(callbacks));
}

std::optional<Event> Subscriptions::next(Clock::time_point until) {
  const auto left = std::chrono::duration_cast<milliseconds>(until - Clock::now());
  return queue_.pop_for(std::max(left, milliseconds(0)));
}

Devices::Devices(const bus::BusOptions& options) : subscriptions_(options) {
  subscriptions_.read(kDeviceInfoTopic, true);
}

std::optional<Event> Devices::next(Clock::time_point until) {
  while (std::optional<Event> event = subscriptions_.next(until)) {
    if (!take(*event)) return event;
  }
  return std::nullopt;
}

/// Whether it is of the devices' own topics, or news.
bool Devices::take(const Event& event) {
  try {
    if (!event.bytes) {
      forget_silent();
      return true;
    }
    if (event.topic == kDeviceInfoTopic) {
      take_info(event);
      return true;
    }
    for (auto& [root, device] : devices_) {
      if (event.topic == notifications_of(root)) {
        take_notification(device, event);
        return true;
      }
    }
    return false;
  } catch (const ros::WireError& error) {
    SPDLOG_WARN("event=message_refused topic={} cause=\"{}\"", event.topic, error.what());
    return true;
  }
}

void Devices::take_info(const Event& event) {
  const std::optional<DeviceInfo> info = parse_device_info(read_flexible(event.cdr()));
  if (!info) return forget(event.writer);
  Device& device = devices_[info->topic_root];
  device.info = *info;
  device.announcer = event.writer;
  subscriptions_.read(notifications_of(info->topic_root), true);
}

void Devices::forget(const bus::WriterId& announcer) {
  std::erase_if(devices_, [&](const auto& item) {
    if (item.second.announcer != announcer) return false;
    subscriptions_.read(notifications_of(item.first), false);
    return true;
  });
}

void Devices::forget_silent() {
  std::set<bus::WriterId> gone;
  for (const auto& [root, device] : devices_) {
    if (!subscriptions_.writes(kDeviceInfoTopic, device.announcer)) gone.insert(device.announcer);
  }
  for (const bus::WriterId& announcer : gone) forget(announcer);
}

}  // namespace rtd::camera::realsense
