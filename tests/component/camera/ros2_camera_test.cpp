// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd-camera with a ROS 2 camera driver: writers of other participants with the QoS and messages that drivers have.
#include <gmock/gmock.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "common/bus/raw_bus.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/config.hpp"
#include "tests/component/camera/camera_on_bus.hpp"

namespace rtd::camera {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;
constexpr const char* kSource = "ros2:/cam/color/image_raw,/cam/aligned_depth_to_color/image_raw";

/// A driver in a thread: 30 frames a second until it ends. Its stamps continue where those of the one before ended.
class Driver {
 public:
  Driver(const bus::BusOptions& options, bool reliable, const std::string& depth_encoding = "16UC1")
      : Driver(options, reliable, depth_encoding, "camera_color_optical_frame") {}
  Driver(const bus::BusOptions& options, bool reliable, const std::string& depth_encoding,
         const std::string& depth_frame)
      : bus_(bus::connect_raw(options)), depth_encoding_(depth_encoding), depth_frame_(depth_frame) {
    color_ = writer("rt/cam/color/image_raw", "Image", reliable);
    depth_ = writer("rt/cam/aligned_depth_to_color/image_raw", "Image", reliable);
    unaligned_ = writer("rt/cam/depth/image_rect_raw", "Image", reliable);
    info_ = writer("rt/cam/color/camera_info", "CameraInfo", reliable);
    depth_info_ = writer("rt/cam/depth/camera_info", "CameraInfo", reliable);
    thread_ = std::thread([this] { run(); });
  }
  ~Driver() {
    ended_ = true;
    thread_.join();
  }

  /// The next colour image of another driver.
  static std::vector<std::uint8_t> color_of_another() { return ros::encode<ros::Wire::kCdr>(image("rgb8", 3, 99)); }

 private:
  std::unique_ptr<bus::RawWriter> writer(const std::string& topic, const std::string& type, bool reliable) {
    bus::RawWriterOptions options;
    options.qos.reliable = reliable;
    options.qos.depth = 5;
    return bus_->writer({topic, "sensor_msgs::msg::dds_::" + type + "_"}, options);
  }
  template <class Message>
  static void send(bus::RawWriter& writer, const Message& message) {
    const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(message);
    writer.write(std::as_bytes(std::span(cdr)));
  }
  static msg::Image image(const char* encoding, std::uint32_t pixel_bytes, std::uint8_t value,
                          const std::string& frame = "camera_color_optical_frame") {
    msg::Image image;
    image.header = {msg::to_time(stamp_ns_), frame};
    image.width = kWidth;
    image.height = kHeight;
    image.encoding = encoding;
    image.step = kWidth * pixel_bytes;
    image.data.assign(std::size_t{image.step} * kHeight, value);
    return image;
  }
  void run() {
    for (; !ended_; stamp_ns_ += 33'000'000) {
      msg::CameraInfo info;
      info.header.stamp = msg::to_time(stamp_ns_);
      info.width = kWidth;
      info.height = kHeight;
      info.distortion_model = "plumb_bob";
      info.k = {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1};
      send(*info_, info);
      send(*depth_info_, info);
      send(*color_, image("rgb8", 3, 77));
      send(*depth_, image(depth_encoding_.c_str(), 2, 1));  // 257 mm
      send(*unaligned_, image(depth_encoding_.c_str(), 2, 1, depth_frame_));
      std::this_thread::sleep_for(33ms);
    }
  }

  std::shared_ptr<bus::RawBus> bus_;
  const std::string depth_encoding_, depth_frame_;
  std::unique_ptr<bus::RawWriter> color_, depth_, unaligned_, info_, depth_info_;
  inline static std::atomic<std::int64_t> stamp_ns_ = 1'000'000'000;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// Publishes once, latched, that the depth camera is 0.1 m in front of the colour camera.
class Mounting {
 public:
  explicit Mounting(const bus::BusOptions& options) : bus_(bus::connect_raw(options)) {
    bus::RawWriterOptions latched;
    latched.qos.durability = bus::RawQos::Durability::kTransientLocal;
    latched.qos.depth = 1;
    writer_ = bus_->writer({"rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_"}, latched);
    msg::TransformStamped transform;
    transform.header.frame_id = "camera_color_optical_frame";
    transform.child_frame_id = "camera_depth_optical_frame";
    transform.transform.translation.z = 0.1;
    const std::vector<std::uint8_t> cdr = ros::encode<ros::Wire::kCdr>(msg::TFMessage{{transform}});
    writer_->write(std::as_bytes(std::span(cdr)));
  }

 private:
  std::shared_ptr<bus::RawBus> bus_;
  std::unique_ptr<bus::RawWriter> writer_;
};

class Ros2Camera : public test::CameraOnBus {
 protected:
  Ros2Camera() : CameraOnBus(kSource) {}
};

TEST_P(Ros2Camera, plays_a_driver_that_sends_best_effort) {
  const Driver driver(options_, false);
  auto running = start();
  ASSERT_TRUE(frames_come(10));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  const auto frame = frames_.all().back();
  EXPECT_EQ(frame->width, std::uint32_t{kWidth});
  EXPECT_EQ(frame->color_bgr[100], 77);
  EXPECT_EQ(frame->depth[5], 257);
  EXPECT_DOUBLE_EQ(frame->depth_scale_m, 0.001);
  EXPECT_DOUBLE_EQ(frame->intrinsics[0], 60);
}

TEST_P(Ros2Camera, follows_the_first_of_two_publishers_and_counts_what_the_other_sends) {
  if (options_.vendor == "cyclonedds") GTEST_SKIP() << "within a process its samples do not name their writer";
  const auto anna = bus_->of_robot("anna")->writer(bus::topics::kDepthJpeg);
  auto running = start();
  EXPECT_TRUE(said(msg::ServiceState::kStarting, "and neither has any image topic"))
      << "our own preview of depth is no camera, nor is that of another robot";
  const Driver first(options_, true);
  ASSERT_TRUE(frames_come());
  const std::shared_ptr<bus::RawBus> second = bus::connect_raw(options_);
  const auto writer = second->writer({"rt/cam/color/image_raw", "sensor_msgs::msg::dds_::Image_"}, {});
  const auto counted = [](const auto& all) {
    return std::ranges::any_of(all, [](const auto& status) {
      return service::find_metric(*status, "left_out.other_camera").value_or(0) >= 3;
    });
  };
  for (int i = 0; i < 300 && !counted(statuses_.all()); ++i) {
    const std::vector<std::uint8_t> image = Driver::color_of_another();
    writer->write(std::as_bytes(std::span(image)));
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(counted(statuses_.all()));
  EXPECT_TRUE(frames_come());
  for (const auto& frame : frames_.all()) EXPECT_EQ(frame->color_bgr[100], 77);
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_P(Ros2Camera, waits_for_a_reliable_driver_survives_its_restart_and_stops_at_once) {
  auto running = start();
  EXPECT_TRUE(said(msg::ServiceState::kStarting, "it has no publisher in DDS domain"));
  auto driver = std::make_unique<Driver>(options_, true);
  EXPECT_TRUE(frames_come());
  driver.reset();
  EXPECT_TRUE(said(msg::ServiceState::kDegraded, "no colour image on /cam/color/image_raw"));
  driver = std::make_unique<Driver>(options_, false);
  EXPECT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_P(Ros2Camera, ends_with_a_reason_for_an_encoding_that_it_cannot_read) {
  const Driver driver(options_, true, "YUV422");
  EXPECT_EQ(run(), service::kRunFailed);
  EXPECT_TRUE(said(msg::ServiceState::kFailed, "'YUV422'"));
}

TEST_P(Ros2Camera, registers_depth_by_tf_static) {
  config_.source = "ros2:/cam/color/image_raw,/cam/depth/image_rect_raw";
  const Driver driver(options_, false, "16UC1", "camera_depth_optical_frame");
  auto running = start();
  EXPECT_TRUE(said(msg::ServiceState::kStarting, "not registered to colour"));
  const Mounting mounting(options_);
  EXPECT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  const auto frame = frames_.all().back();
  EXPECT_EQ(frame->depth[kWidth * kHeight / 2 + kWidth / 2], 357);
  EXPECT_EQ(frame->depth[0], 0) << "the colour camera sees more than the depth camera";
}

TEST_P(Ros2Camera, refuses_unregistered_depth_with_the_reason) {
  config_.source = "ros2:/cam/color/image_raw,/cam/depth/image_rect_raw";
  const Driver driver(options_, true, "16UC1", "camera_depth_optical_frame");
  EXPECT_EQ(run(), service::kRunFailed);
  EXPECT_TRUE(said(msg::ServiceState::kFailed, "'camera_depth_optical_frame' to 'camera_color_optical_frame'"));
}

TEST_P(Ros2Camera, gives_up_in_time_and_stops_while_it_waits) {
  config_.start_timeout_s = 0.3;
  EXPECT_EQ(run(), service::kRunFailed);
  EXPECT_TRUE(said(msg::ServiceState::kFailed, "no frame within 0.3 s"));
  config_.start_timeout_s = 60;
  auto running = start();
  EXPECT_TRUE(said(msg::ServiceState::kStarting, "no colour image"));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

/// A recording with an IMU and tf, as robots make it.
class RecordedRobot : public test::CameraOnBus {
 protected:
  RecordedRobot() : CameraOnBus("mcap:" + file()) {}
  static std::string file() {
    const char* const data = std::getenv("RTD_DATA_DIR");
    return std::string(data == nullptr ? "" : data) + "/field/recording_with_imu_and_tf/imu_tf.mcap";
  }
};

TEST_P(RecordedRobot, brings_its_imu_and_its_transforms) {
  if (!std::filesystem::exists(file())) GTEST_SKIP() << "no " << file();
  config_.sensor_topics = {"/camera/imu", "/tf_static"};
  std::atomic<int> samples{0};
  const auto raw = bus::connect_raw(options_);
  bus::RawHandlers handlers;
  handlers.on_sample = [&samples](const bus::RawSample&) { ++samples; };
  const auto imu =
      raw->reader({"rt/camera/imu", "sensor_msgs::msg::dds_::Imu_"}, {.transient_local = true}, std::move(handlers));
  test_support::Inbox<msg::TFMessage> transforms;
  const auto tf = bus_->reader<msg::TFMessage>(bus::topics::kTfStatic, [&](auto message) { transforms.take(message); });
  auto running = start();
  EXPECT_TRUE(transforms.wait_count(1));
  EXPECT_EQ(transforms.at(0)->transforms.size(), 2U) << "base_link, camera_link, optical frame";
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_GE(samples, 30) << "of 60, the last ones after the last frame";
}

TEST_P(RecordedRobot, refuses_a_topic_that_it_does_not_have_with_those_it_has) {
  if (!std::filesystem::exists(file())) GTEST_SKIP() << "no " << file();
  config_.sensor_topics = {"/other"};
  EXPECT_THAT([this] { run(); }, ::testing::ThrowsMessage<service::ConfigError>(
                                     ::testing::AllOf(HasSubstr("/other"), HasSubstr("/camera/imu"))));
}

INSTANTIATE_TEST_SUITE_P(EachVendor, RecordedRobot, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RecordedRobot);

INSTANTIATE_TEST_SUITE_P(EachVendor, Ros2Camera, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Ros2Camera);

}  // namespace
}  // namespace rtd::camera
