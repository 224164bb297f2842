// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <deque>
#include <set>

#include "services/camera/core/live/device_source.hpp"
#include "services/camera/ros2/ros2_device.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/played_device.hpp"

namespace rtd::camera {

/// A camera that a test plays. An empty feed lets its clock continue, and closes it after a minute.
struct FeedScript {
  std::deque<RecordedMessage> messages;
  std::uint64_t dropped = 0;
  std::set<std::string> published;
  bool clears = false;  ///< as the real one; a test of one stream leaves it off
  test::PlayedTime time{.now_ns = 0};
};

class PlayedFeed : public LiveFeed {
 public:
  explicit PlayedFeed(FeedScript& script) : script_(script) {}

  std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) override {
    test::PlayedTime& time = script_.time;
    if (script_.messages.empty()) {
      time.go_on(std::chrono::nanoseconds(timeout).count());
      time.closed = time.closed || time.now_ns > 60'000'000'000;
      return std::nullopt;
    }
    RecordedMessage message = std::move(script_.messages.front());
    script_.messages.pop_front();
    time.go_on(1'000'000);
    message.recorded_ns = time.now_ns;
    return message;
  }
  void clear() override {
    if (script_.clears) script_.messages.clear();
  }
  std::uint64_t dropped() const override { return script_.dropped; }
  std::int64_t now_ns() const override { return script_.time.now_ns; }
  std::string state_of(const std::string& topic) const override { return "state of " + topic; }
  bool is_published(const std::string& topic) const override { return script_.published.contains(topic); }

 private:
  FeedScript& script_;
};

class Ros2DeviceTest : public ::testing::Test {
 protected:
  static constexpr const char* kUri = "ros2:/c,/d,/i";

  template <class Message>
  void add(const std::string& topic, const std::string& type, const Message& message) {
    RecordedMessage live;
    live.type = type;
    live.topic = topic;
    live.wire = ros::Wire::kCdr;
    live.bytes = ros::encode<ros::Wire::kCdr>(message);
    script_.messages.push_back(std::move(live));
  }
  void info(const msg::CameraInfo& info = test::ImageBag::camera_info()) { add("/i", "sensor_msgs/CameraInfo", info); }
  void color(double stamp_s, const cv::Mat& pixels = test::ImageBag::color(), const std::string& encoding = "bgr8") {
    add("/c", "sensor_msgs/Image", test::ImageBag::image(pixels, encoding, stamp_s));
  }
  void depth(double stamp_s, const cv::Mat& pixels = test::ImageBag::depth(), const std::string& encoding = "16UC1") {
    add("/d", "sensor_msgs/Image", test::ImageBag::image(pixels, encoding, stamp_s));
  }
  void both(double stamp_s) {
    color(stamp_s);
    depth(stamp_s);
  }
  /// What open() waits for.
  void begin() {
    info();
    both(1.0);
  }
  DeviceSource source(const std::string& uri = kUri) {
    script_.time = {.now_ns = 0};
    const LiveOptions ros2 = parse_live_options(uri);
    DeviceOptions options;
    options.uri.text = uri;
    options.uri.calibration_file = ros2.calibration_file;
    options.uri.tolerance_ns = ros2.tolerance_ns;
    options.on_wait = [this](const std::string& what) { reported_.push_back(what); };
    return {std::make_unique<Ros2Device>(uri, std::make_unique<PlayedFeed>(script_), ros2),
            std::make_unique<test::PlayedClock>(script_.time), options};
  }
  /// The frame made of one pair of images.
  static SourceFrame only_frame(DeviceSource& source) {
    EXPECT_TRUE(source.open());
    return source.next().value();
  }

  FeedScript script_;
  std::vector<std::string> reported_;
};

}  // namespace rtd::camera
