// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/live_camera.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "common/service/monotonic_clock.hpp"
#include "services/camera/core/live/device_source.hpp"
#include "services/camera/openni2/oni_file.hpp"
#include "services/camera/openni2/openni2_device.hpp"
#include "services/camera/realsense/realsense_device.hpp"
#include "services/camera/ros2/ros2_feed.hpp"

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
  DeviceOptions options{{}, open_timeout_ns, epoch_ns(), std::move(on_wait)};
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
