// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera::test {

/// The time of a test: it continues when a thread waits, and closes after ten minutes.
struct PlayedTime {
  std::int64_t now_ns = 1'000'000'000'000;
  bool closed = false;
  std::multimap<std::int64_t, std::function<void()>> events;  ///< what happens when

  void after(double seconds, std::function<void()> event) {
    events.emplace(now_ns + static_cast<std::int64_t>(seconds * 1e9), std::move(event));
  }
  void go_on(std::int64_t by_ns) {
    now_ns += by_ns;
    closed = closed || now_ns > 1'600'000'000'000;
    while (!events.empty() && events.begin()->first <= now_ns) {
      events.begin()->second();
      events.erase(events.begin());
    }
  }
};

class PlayedClock final : public DeviceClock {
 public:
  explicit PlayedClock(PlayedTime& time) : time_(time) {}
  std::int64_t now_ns() const override { return time_.now_ns; }
  void wait(std::chrono::milliseconds time) override { time_.go_on(std::chrono::nanoseconds(time).count()); }
  void close() override { time_.closed = true; }
  bool closed() const override { return time_.closed; }

 private:
  PlayedTime& time_;
};

/// What a test does to the camera, and what it counted.
struct DeviceScript {
  static constexpr int kWidth = 32, kHeight = 24;
  bool plugged = true, gives_color = true, gives_depth = true, frozen = false, knows_lens = true;
  int every = 1;                  ///< of so many frames one arrives
  int depth_units = 1500;         ///< 0 = no measurement
  std::int64_t clock_ns = 0;      ///< the device's clock minus the host's
  std::int64_t depth_lag_ns = 0;  ///< of the depth stamps
  std::optional<DeviceError> fails_to_open = {};
  cv::Size size_px{kWidth, kHeight};
  int opened = 0, closed = 0, open_now = 0;
};

/// A camera at 30 Hz in the time of a test.
class PlayedDevice final : public LiveDevice {
 public:
  static constexpr std::int64_t kPeriodNs = 33'000'000;
  PlayedDevice(DeviceScript& script, PlayedTime& time) : script_(script), time_(time) {}
  ~PlayedDevice() override { close(); }

  std::string name() const override { return "played:1"; }
  void open() override {
    require_plugged();
    if (script_.fails_to_open) throw *script_.fails_to_open;
    open_ = true;
    ++script_.opened;
    ++script_.open_now;
  }
  std::vector<DeviceMode> modes() const { return {mode(Stream::kColor), mode(Stream::kDepth)}; }
  std::optional<DeviceSetup> start(const ModeRequest& request) override {
    const DeviceMode color = choose_mode(modes(), Stream::kColor, request, name());
    DeviceSetup setup{color, mode(Stream::kDepth), 0.001, {}};
    const auto [width, height] = std::pair(script_.size_px.width, script_.size_px.height);
    if (script_.knows_lens) setup.camera = geometry::CameraModel({30, 30, 15.5, 11.5, {}, width, height});
    next_ns_ = time_.now_ns + kPeriodNs;
    depth_follows_ = false;
    return setup;
  }
  std::optional<DeviceImage> read(std::chrono::milliseconds timeout) override {
    require_plugged();
    const std::int64_t until_ns = time_.now_ns + std::chrono::nanoseconds(timeout).count();
    if (std::exchange(depth_follows_, false) && script_.gives_depth) return image(Stream::kDepth);
    while (next_ns_ <= until_ns) {
      time_.go_on(std::max<std::int64_t>(0, next_ns_ - time_.now_ns));
      next_ns_ += kPeriodNs;
      if (++frames_ % script_.every != 0) continue;
      if (!script_.gives_color) {
        if (script_.gives_depth) return image(Stream::kDepth);
        continue;
      }
      depth_follows_ = true;
      return image(Stream::kColor);
    }
    time_.go_on(until_ns - time_.now_ns);
    return std::nullopt;
  }
  void close() noexcept override {
    if (!std::exchange(open_, false)) return;
    ++script_.closed;
    --script_.open_now;
  }

 private:
  void require_plugged() const {
    if (!script_.plugged) throw DeviceError(DeviceProblem::kAbsent, "played:1 was unplugged");
  }
  DeviceMode mode(Stream stream) const {
    return {stream, script_.size_px, 30, stream == Stream::kColor ? "BGR8" : "Z16"};
  }
  DeviceImage image(Stream stream) const {
    const auto pixels = static_cast<std::size_t>(script_.size_px.area());
    DeviceImage image{stream, next_ns_ - kPeriodNs + script_.clock_ns, {}};
    if (stream == Stream::kColor) {
      image.message.bytes.assign(3 * pixels, script_.frozen ? 7 : static_cast<std::uint8_t>(frames_));
    } else {
      image.stamp_ns += script_.depth_lag_ns;
      for (std::size_t i = 0; i < pixels; ++i) {
        image.message.bytes.push_back(static_cast<std::uint8_t>(script_.depth_units & 0xFF));
        image.message.bytes.push_back(static_cast<std::uint8_t>(script_.depth_units >> 8));
      }
    }
    return image;
  }

  DeviceScript& script_;
  PlayedTime& time_;
  std::int64_t next_ns_ = 0;
  int frames_ = 0;
  bool open_ = false, depth_follows_ = false;
};

}  // namespace rtd::camera::test
