// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/live_camera.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "common/service/monotonic_clock.hpp"
#include "services/camera/core/live/device_source.hpp"
#include "services/camera/core/live/live_source.hpp"
#include "services/camera/core/oni/oni_file.hpp"
#include "services/camera/devices/device_factory.hpp"
#include "services/camera/realsense_device.hpp"
#include "services/camera/ros2_feed.hpp"

namespace rtd::camera {
namespace {

/// The time of this host.
class HostClock final : public DeviceClock {
 public:
  std::int64_t now_ns() const override { return service::monotonic_ns(); }
  void wait(std::chrono::milliseconds time) override {
    std::unique_lock lock(mutex_);
    change_.wait_for(lock, time, [this] { return closed_; });
  }
  void close() override {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    change_.notify_all();
  }
  bool closed() const override {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable change_;
  bool closed_ = false;
};

/// Unix time minus the time of HostClock.
std::int64_t epoch_ns() {
  const auto unix_time = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(unix_time).count() - service::monotonic_ns();
}

/// Before OpenNI2's library reads a file.
void check_recorded(const DeviceUri& uri) {
  try {
    require_oni_file(uri.device);
  } catch (const OniFileError& error) {
    throw SourceError(error.what());
  }
}

}  // namespace

std::unique_ptr<FrameSource> make_live_source(const std::string& uri, const bus::BusOptions& bus,
                                              std::int64_t open_timeout_ns,
                                              std::function<void(const std::string&)> on_wait) {
  if (is_device(uri)) {
    DeviceOptions options{parse_device_uri(uri), open_timeout_ns, epoch_ns(), std::move(on_wait)};
    if (options.uri.scheme == "openni2") check_recorded(options.uri);
    const bool on_bus = options.uri.scheme == "realsense-dds";
    std::unique_ptr<LiveDevice> device =
        on_bus ? make_realsense_device(bus, options.uri.device) : make_device(options.uri);
    return std::make_unique<DeviceSource>(std::move(device), std::make_unique<HostClock>(), std::move(options));
  }
  LiveOptions options = parse_live_options(uri);
  options.open_timeout_ns = open_timeout_ns;
  options.on_wait = std::move(on_wait);
  auto feed = std::make_unique<Ros2Feed>(bus, options.topics);
  return std::make_unique<LiveSource>(uri, std::move(feed), std::move(options));
}

}  // namespace rtd::camera
