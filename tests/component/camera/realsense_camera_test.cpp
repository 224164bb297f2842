// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd-camera with a RealSense camera on DDS: writers of another participant with the topics, types, QoS and messages of
// librealsense's documentation (third-party/realdds/doc).
#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/raw_bus.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/camera/core/live/realsense_protocol.hpp"
#include "services/camera/realsense_device.hpp"
#include "tests/component/camera/camera_on_bus.hpp"

namespace rtd::camera {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;

/// A camera in a thread: 30 frames a second while they are subscribed. Depth is taken 0.1 m in front of colour.
class RealsenseDouble {
 public:
  RealsenseDouble(const bus::BusOptions& options, const std::string& serial)
      : bus_(connect(options)), serial_(serial), root_("realsense/D555_" + serial) {
    info_ = writer(realsense::kDeviceInfoTopic, realsense::kFlexibleType, true);
    notification_ = writer(root_ + "/notification", realsense::kFlexibleType, true);
    color_ = writer("rt/" + root_ + "_Color", "sensor_msgs::msg::dds_::Image_", false);
    depth_ = writer("rt/" + root_ + "_Depth", "sensor_msgs::msg::dds_::Image_", false);
    bus::RawHandlers handlers;
    handlers.on_sample = [this](const bus::RawSample& sample) { take_request(sample); };
    control_ = bus_->reader({root_ + "/control", realsense::kFlexibleType}, {}, handlers);
    thread_ = std::thread([this] { run(); });
  }
  ~RealsenseDouble() {
    ended_ = true;
    thread_.join();
  }
  void announce_stop() { stopping_ = true; }
  void refuse_requests() { refuses_ = true; }

 private:
  /// The cameras use Fast DDS; Cyclone DDS has no topics with '-' in their names.
  static std::shared_ptr<bus::RawBus> connect(bus::BusOptions options) {
    options.vendor = "fastdds";
    return bus::connect_raw(options);
  }
  std::unique_ptr<bus::RawWriter> writer(const std::string& topic, const std::string& type, bool reliable) {
    bus::RawWriterOptions options;
    options.qos.reliable = reliable;
    options.qos.depth = 10;
    return bus_->writer({topic, type}, options);
  }
  static void send(bus::RawWriter& writer, const json& message) {
    const std::vector<std::uint8_t> cdr = realsense::write_flexible(message);
    writer.write(std::as_bytes(std::span(cdr)));
  }
  void take_request(const bus::RawSample& sample) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sample.cdr().data());
    const json request = realsense::read_flexible({bytes, sample.cdr().size()});
    const json& color = request.at("stream-profiles").at("Color");
    const std::lock_guard lock(mutex_);
    if (!refuses_) width_ = color.at(2), height_ = color.at(3);
    reply_ = {{"id", "open-streams"}, {"status", refuses_ ? "error" : "ok"}};
    if (refuses_) (*reply_)["explanation"] = "the sensor streams to another program";
  }
  void describe() {
    send(*notification_, {{"id", "device-header"},
                          {"n-streams", 3},
                          {"extrinsics",
                           {{"Depth", "Infrared 1", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}},
                            {"Color", "Infrared 1", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -0.1}}}}});
    send(*notification_, stream("Depth", "depth", {{30, "16UC1", kWidth, kHeight}}));
    send(*notification_, options("Depth"));
    send(*notification_, stream("Infrared 1", "ir", {{30, "mono8", kWidth, kHeight}}));
    send(*notification_, options("Infrared 1"));
    send(*notification_,
         stream("Color", "color", {{30, "rgb8", kWidth, kHeight}, {30, "rgb8", 2 * kWidth, 2 * kHeight}}));
    send(*notification_, options("Color"));
  }
  static json stream(const char* name, const char* type, const json& profiles) {
    return {{"id", "stream-header"}, {"name", name},         {"type", type},
            {"profiles", profiles},  {"sensor-name", "any"}, {"default-profile-index", 0}};
  }
  static json options(const char* name) {
    return {{"id", "stream-options"},
            {"stream-name", name},
            {"options", {{"Depth Units", 0.002, 0.0001, 0.01, 0.0001, 0.001, "m"}}},
            {"intrinsics",
             {{"width", kWidth}, {"height", kHeight}, {"principal-point", {31.5, 23.5}}, {"focal-length", {60, 60}}}}};
  }
  void send_image(bus::RawWriter& writer, const char* encoding, int width, int height, std::uint32_t pixel_bytes,
                  std::uint8_t value) const {
    msg::Image image;
    image.header = {msg::to_time(stamp_ns_), serial_};
    image.width = static_cast<std::uint32_t>(width), image.height = static_cast<std::uint32_t>(height);
    image.encoding = encoding;
    image.step = image.width * pixel_bytes + 8;  // rows with bytes between them
    image.data.assign(std::size_t{image.step} * image.height, value);
    const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(image);
    writer.write(std::as_bytes(std::span(cdr)));
  }
  void run() {
    int known = 0, listening = 0;
    for (; !ended_; stamp_ns_ += 33'000'000) {
      if (info_->matched() > known) {
        send(*info_, {{"name", "RealSense D555"}, {"serial", serial_}, {"topic-root", root_}});
      }
      known = info_->matched();
      if (notification_->matched() > listening) describe();
      listening = notification_->matched();
      if (stopping_) send(*info_, {{"stopping", true}});
      const std::lock_guard lock(mutex_);
      if (reply_) send(*notification_, *std::exchange(reply_, std::nullopt));
      if (color_->matched() > 0) send_image(*color_, "rgb8", width_, height_, 3, 77);
      if (depth_->matched() > 0) send_image(*depth_, "16UC1", kWidth, kHeight, 2, 1);  // 257 units
      std::this_thread::sleep_for(33ms);
    }
  }

  std::shared_ptr<bus::RawBus> bus_;
  const std::string serial_, root_;
  std::unique_ptr<bus::RawWriter> info_, notification_, color_, depth_;
  std::unique_ptr<bus::RawReader> control_;
  std::mutex mutex_;
  std::optional<json> reply_;
  int width_ = kWidth, height_ = kHeight;
  std::int64_t stamp_ns_ = 1'000'000'000;
  std::atomic<bool> ended_{false}, stopping_{false}, refuses_{false};
  std::thread thread_;
};

class RealsenseCamera : public test::CameraOnBus {
 protected:
  RealsenseCamera() : CameraOnBus("realsense-dds:") {}
};

TEST_P(RealsenseCamera, plays_a_device_and_registers_its_depth) {
  config_.source = "realsense-dds:?width=64&height=48";
  const RealsenseDouble device(options_, "1234");
  auto running = start();
  ASSERT_TRUE(frames_come(10));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  const auto frame = frames_.all().back();
  EXPECT_EQ(frame->width, std::uint32_t{kWidth});
  EXPECT_EQ(frame->color_bgr[100], 77);
  EXPECT_DOUBLE_EQ(frame->intrinsics[0], 60);
  EXPECT_NEAR(frame->depth_scale_m, 0.002, 1e-9) << "the device's own unit";
  EXPECT_EQ(frame->depth[kWidth * kHeight / 2 + kWidth / 2], 257 + 50) << "0.1 m in front of colour";
  EXPECT_EQ(frame->depth[0], 0) << "the colour camera sees more than the depth camera";
}

TEST_P(RealsenseCamera, asks_the_device_for_the_size_and_scales_its_calibration) {
  config_.source = "realsense-dds:1234?width=128&height=96";
  const RealsenseDouble device(options_, "1234");
  auto running = start();
  ASSERT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  const auto frame = frames_.all().back();
  EXPECT_EQ(frame->width, 128U);
  EXPECT_DOUBLE_EQ(frame->intrinsics[0], 120);
  EXPECT_DOUBLE_EQ(frame->intrinsics[2], 63.5);
  EXPECT_GT(frame->depth[128 * 48 + 64], 0) << "depth of half the size is registered without cracks";
}

TEST_P(RealsenseCamera, takes_the_mode_that_another_program_has_chosen) {
  config_.source = "realsense-dds:?width=128&height=96";
  RealsenseDouble device(options_, "1234");
  device.refuse_requests();
  auto running = start();
  ASSERT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_EQ(frames_.all().back()->width, std::uint32_t{kWidth});
}

TEST_P(RealsenseCamera, waits_for_a_device_and_bears_that_it_goes_and_comes) {
  auto running = start();
  EXPECT_TRUE(said(msg::ServiceState::kStarting, "no RealSense device announces itself"));
  auto device = std::make_unique<RealsenseDouble>(options_, "1234");
  EXPECT_TRUE(frames_come());
  device.reset();
  EXPECT_TRUE(said(msg::ServiceState::kDegraded, "was unplugged"));
  device = std::make_unique<RealsenseDouble>(options_, "1234");
  EXPECT_TRUE(frames_come());
  device->announce_stop();
  EXPECT_TRUE(statuses_.wait([](const auto& all) { return all.back()->state == msg::ServiceState::kDegraded; }));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_P(RealsenseCamera, needs_a_serial_where_there_are_several) {
  const RealsenseDouble first(options_, "1234"), second(options_, "5678");
  EXPECT_EQ(run(), service::kRunFailed);
  EXPECT_TRUE(said(msg::ServiceState::kFailed, "2 RealSense devices are in DDS domain"));
  config_.source = "realsense-dds:5678";
  auto running = start();
  EXPECT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_P(RealsenseCamera, devices_are_found_with_their_modes) {
  const RealsenseDouble device(options_, "1234");
  const std::vector<FoundCamera> cameras = find_realsense_cameras(options_);
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].uri, "realsense-dds:1234");
  EXPECT_EQ(cameras[0].problem, "");
  EXPECT_EQ(list_modes(cameras[0].modes, Stream::kColor), "64 x 48 RGB8 30 Hz; 128 x 96 RGB8 30 Hz");
}

INSTANTIATE_TEST_SUITE_P(EachVendor, RealsenseCamera, ::testing::ValuesIn(test::networked_vendors()),
                         [](const auto& vendor) { return vendor.param; });

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RealsenseCamera);

}  // namespace
}  // namespace rtd::camera
