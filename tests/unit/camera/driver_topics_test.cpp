// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <zstd.h>

#include "common/camera/frame_source.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/recording/recording.hpp"
#include "common/msg/imu.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/camera/core/auxiliary_topics.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/two_cameras.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::McapFile;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

/// A recording of which only the topics matter.
class ImageTopicsOnly final : public recordings::Reader {
 public:
  explicit ImageTopicsOnly(const std::vector<std::string>& images) : Reader("x.bag") {
    for (const std::string& name : images) topics_.push_back({name, "sensor_msgs/Image", 1, {}});
  }
  std::vector<std::int64_t> first_times_ns(const std::string&, std::size_t) override { return {}; }
  void play(const std::vector<std::string>&) override {}
  std::optional<RecordedMessage> next() override { return std::nullopt; }
  std::vector<std::string> take_damages() override { return {}; }
};

ImageTopics chosen(const std::vector<std::string>& images, const ImageTopics& named = {}) {
  return choose_topics(ImageTopicsOnly(images), named);
}

TEST(DriverTopics, are_found_by_themselves_behind_any_namespace) {
  const std::vector<TopicPair> cameras = {
      {"/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"},
      {"/camera/camera/color/image_raw", "/camera/camera/aligned_depth_to_color/image_raw"},
      {"/rgb/image_raw", "/depth_to_rgb/image_raw"},
      {"/kinect2/qhd/image_color_rect", "/kinect2/qhd/image_depth_rect"},
      {"/kinect2/hd/image_color", "/kinect2/hd/image_depth_rect"},
      {"/zed/zed_node/rgb/image_rect_color", "/zed/zed_node/depth/depth_registered"},
      {"/oak/rgb/image_raw", "/oak/stereo/image_raw"},
      {"/color/image", "/stereo/depth"},
      {"/camera/color/image_raw", "/camera/depth/image_raw"},
      {"/camera/rgb/image_color", "/camera/depth/image"},
      {"/device_0/sensor_1/Color_0/image/data", "/device_0/sensor_0/Depth_0/image/data"}};
  for (const auto& [color, depth] : cameras) {
    for (const std::string prefix : {"", "/robot/head"}) {
      if (!prefix.empty() && color.starts_with("/device_")) continue;  // the SDK knows no namespaces
      const ImageTopics topics =
          chosen({prefix + depth, "/left/infra1/image_rect_raw", "/map/image", prefix + color, "/other/depth"});
      EXPECT_EQ(topics.color, prefix + color);
      EXPECT_EQ(topics.depth, prefix + depth);
    }
  }
}

TEST(DriverTopics, registered_depth_and_raw_images_come_first) {
  const ImageTopics topics =
      chosen({"/camera/depth/image_rect_raw", "/camera/color/image_raw/compressed", "/camera/color/image_raw",
              "/camera/aligned_depth_to_color/image_raw/compressedDepth", "/camera/aligned_depth_to_color/image_raw"});
  EXPECT_EQ(topics.color, "/camera/color/image_raw");
  EXPECT_EQ(topics.depth, "/camera/aligned_depth_to_color/image_raw");
}

TEST(DriverTopics, images_of_one_resolution_belong_together) {
  const ImageTopics topics =
      chosen({"/kinect2/hd/image_color_rect", "/kinect2/qhd/image_depth_rect", "/kinect2/hd/image_depth_rect"});
  EXPECT_EQ(topics.depth, "/kinect2/hd/image_depth_rect");
}

TEST(DriverTopics, of_two_cameras_both_are_listed_and_one_can_be_named) {
  const std::vector<std::string> images = {"/a/color/image_raw", "/a/aligned_depth_to_color/image_raw",
                                           "/b/color/image_raw", "/b/aligned_depth_to_color/image_raw"};
  EXPECT_THAT([&] { chosen(images); },
              ThrowsMessage<SourceError>(
                  AllOf(HasSubstr("?color=/a/color/image_raw&depth=/a/aligned_depth_to_color/image_raw"),
                        HasSubstr("?color=/b/color/image_raw&depth=/b/"), HasSubstr("?color=TOPIC&depth=TOPIC"))));
  EXPECT_EQ(chosen(images, {.color = "/b/color/image_raw", .depth = {}, .info = {}, .depth_info = {}}).depth,
            images[3]);
}

/// As the RealSense SDK records: all in frame "0", the unit in an option of the sensor.
std::string sdk_bag(ImageBag& bag, float unit_m) {
  const std::string color = "/device_0/sensor_1/Color_0", depth = "/device_0/sensor_0/Depth_0";
  msg::Image color_image = ImageBag::image(ImageBag::color(), "rgb8", 1);
  msg::Image depth_image = ImageBag::image(ImageBag::depth(), "mono16", 1);
  color_image.header.frame_id = depth_image.header.frame_id = "0";
  for (const std::string& stream : {color, depth}) {
    bag.add(stream + "/info/camera_info", "sensor_msgs/CameraInfo", ImageBag::camera_info(), 0.5);
    bag.add(stream + "/tf/0", "geometry_msgs/Transform", msg::RosTransform{{0, 0, 0}, {0, 0, 0, 1}}, 0.5);
  }
  bag.add("/device_0/sensor_0/option/Depth_Units/value", "std_msgs/Float32", std::array<float, 1>{unit_m}, 0.5);
  bag.add(color + "/image/data", "sensor_msgs/Image", color_image, 1);
  bag.add(depth + "/image/data", "sensor_msgs/Image", depth_image, 1);
  return bag.uri();
}

TEST(RealSenseSdkBag, topics_calibration_and_depth_unit_are_found) {
  ImageBag bag;
  const auto source = make_source(sdk_bag(bag, 0.00025F));
  EXPECT_NEAR(source->info().depth_scale_m, 0.00025, 1e-9);
  EXPECT_DOUBLE_EQ(source->info().camera.parameters().fx, 30);
  EXPECT_TRUE(source->next());
}

TEST(RealSenseSdkBag, a_unit_that_cannot_be_is_refused) {
  for (const float unit_m : {0.0F, -1.0F, 7.0F, NAN}) {
    ImageBag bag;
    const std::string uri = sdk_bag(bag, unit_m);
    EXPECT_TRUE(test::refuses(uri, {"Depth_Units", "?depth_factor="}));
    EXPECT_DOUBLE_EQ(make_source(uri + "?depth_factor=1000")->info().depth_scale_m, 0.001) << "the advice helps";
  }
}

/// As the SDK records since 2026: what is not an image is a text.
class RealSenseSdkTexts : public testing::TestWithParam<bool> {
 protected:
  /// `bytes`, or the zstd frame of them.
  void add(const std::string& topic, const std::string& type, const std::vector<std::uint8_t>& bytes, double time_s) {
    std::vector<std::uint8_t> stored = bytes;
    if (GetParam()) {
      stored.resize(ZSTD_compressBound(bytes.size()));
      stored.resize(ZSTD_compress(stored.data(), stored.size(), bytes.data(), bytes.size(), 1));
    }
    file_.add(topic, type, "cdr", stored, time_s);
  }
  void text(const std::string& topic, const std::string& text) {
    std::vector<std::uint8_t> bytes = {0, 1, 0, 0};
    for (const std::size_t length = text.size() + 1; bytes.size() < 8;)
      bytes.push_back(static_cast<std::uint8_t>(length >> (8 * (bytes.size() - 4))));
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back(0);
    add(topic, "std_msgs/msg/String", bytes, 0.5);
  }
  void stream(const std::string& name, const geometry::CameraModel& camera, const Eigen::Isometry3d& T_stream_ref) {
    const auto& p = camera.parameters();
    text(name + "/camera_info",
         fmt::format("width={};height={};fx={};ppx={};fy={};ppy={};model=Brown Conrady;coeffs={}", p.width, p.height,
                     p.fx, p.cx, p.fy, p.cy, fmt::join(p.distortion.begin(), p.distortion.begin() + 5, ",")));
    const Eigen::Matrix3d rotation = T_stream_ref.linear();
    const Eigen::Vector3d t = T_stream_ref.translation();
    text(name + "/tf/ref_0",
         fmt::format("rotation={:.9f};translation={:.9f}", fmt::join(rotation.data(), rotation.data() + 9, ","),
                     fmt::join(t.data(), t.data() + 3, ",")));
  }

  test::McapFile file_;
};

TEST_P(RealSenseSdkTexts, give_unit_intrinsics_and_extrinsics) {
  const test::TwoCameras cameras;
  const std::string color = "/device_0/sensor_1/Color_0", depth = "/device_0/sensor_0/Depth_0";
  const Eigen::Isometry3d T_depth_ref =
      Eigen::Isometry3d(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  stream(depth, cameras.depth, T_depth_ref);
  stream(color, cameras.color, cameras.T_color_depth * T_depth_ref);
  text("/device_0/sensor_0/option/Depth_Units/value", "0.001000");
  text("/device_0/sensor_0/Depth_0/image/metadata", "Frame number=0;");
  add(color + "/image/data", "sensor_msgs/msg/Image", ros::encode<ros::Wire::kCdr>(cameras.color_image(1)), 1);
  add(depth + "/image/data", "sensor_msgs/msg/Image", ros::encode<ros::Wire::kCdr>(cameras.depth_image(1)), 1);
  const auto source = make_source(file_.uri());
  EXPECT_DOUBLE_EQ(source->info().depth_scale_m, 0.001);
  EXPECT_DOUBLE_EQ(source->info().camera.parameters().distortion[1], -0.02);
  cameras.expect_registered(source->next().value().image);
}

INSTANTIATE_TEST_SUITE_P(Packed, RealSenseSdkTexts, testing::Bool());

constexpr std::int64_t kOneMs = 1'000'000;

class AuxiliaryTopicsTest : public ::testing::Test {
 protected:
  void imu(double stamp_s) {
    msg::Imu imu;
    imu.header = {msg::to_time(static_cast<std::int64_t>(stamp_s * 1e9)), "imu"};
    file_.add("/imu", "sensor_msgs/msg/Imu", imu, stamp_s);
  }
  void wheels(double stamp_s) {
    msg::Odometry odometry;
    odometry.header = {msg::to_time(static_cast<std::int64_t>(stamp_s * 1e9)), "odom"};
    odometry.pose.pose.orientation.w = 1;
    file_.add("/odom", "nav_msgs/msg/Odometry", odometry, stamp_s);
  }
  static msg::TFMessage link(const char* parent, const char* child) {
    msg::TransformStamped transform;
    transform.header.frame_id = parent;
    transform.child_frame_id = child;
    return {{transform}};
  }
  AuxiliaryTopics beside(const std::vector<std::string>& topics) { return {recording_of(file_.uri()), topics}; }
  /// Stamps in ms of what belongs to a frame.
  static std::vector<std::int64_t> until(AuxiliaryTopics& beside, double stamp_s) {
    std::vector<std::int64_t> stamps_ms;
    for (const auto& message : beside.until(static_cast<std::int64_t>(stamp_s * 1e9))) {
      EXPECT_EQ(message.wire, ros::Wire::kCdr);
      stamps_ms.push_back(msg::to_ns(ros::decode<msg::Header>(message.wire, message.bytes).stamp) / kOneMs);
    }
    return stamps_ms;
  }

  McapFile file_;
};

TEST_F(AuxiliaryTopicsTest, come_up_to_the_first_that_is_not_before_the_frame) {
  for (int i = 0; i < 10; ++i) imu(1.0 + 0.01 * i);
  AuxiliaryTopics played = beside({"/imu"});
  EXPECT_THAT(until(played, 1.025), ElementsAre(1000, 1010, 1020, 1030));
  EXPECT_THAT(until(played, 1.028), IsEmpty());
  EXPECT_THAT(until(played, 1.05), ElementsAre(1040, 1050));
  EXPECT_THAT(until(played, 2.0), ElementsAre(1060, 1070, 1080, 1090));
  EXPECT_THAT(until(played, 2.1), IsEmpty()) << "the end";
}

TEST_F(AuxiliaryTopicsTest, of_two_topics_none_is_read_far_ahead_for_the_other) {
  imu(1.0);
  for (int i = 0; i < 100; ++i) wheels(1.0 + 0.1 * i);
  AuxiliaryTopics played = beside({"/imu", "/odom"});
  EXPECT_THAT(until(played, 1.0), ElementsAre(1000, 1000));
  EXPECT_EQ(until(played, 1.1).back(), 1700) << "the IMU has ended: half a second ahead";
}

TEST_F(AuxiliaryTopicsTest, leave_out_what_is_long_before_the_first_frame) {
  for (int i = 0; i < 8; ++i) imu(1.0 + i);
  AuxiliaryTopics played = beside({"/imu"});
  EXPECT_THAT(until(played, 6.5), ElementsAre(5000, 6000, 7000));
}

TEST_F(AuxiliaryTopicsTest, lasting_transforms_are_those_of_tf_static_and_what_else_tf_has) {
  file_.add("/tf", "tf2_msgs/msg/TFMessage", link("odom", "base_link"), 1.0);
  file_.add("/tf", "tf2_msgs/msg/TFMessage", link("wrong", "camera_link"), 1.1);
  file_.add("/tf_static", "tf2_msgs/msg/TFMessage", link("base_link", "camera_link"), 1.2);
  const auto recording = recording_of(file_.uri());
  std::vector<std::string> links;
  for (const auto& transform : lasting_transforms(*recording).transforms)
    links.push_back(transform.header.frame_id + " " + transform.child_frame_id);
  EXPECT_THAT(links, ElementsAre("base_link camera_link", "odom base_link"));
}

TEST_F(AuxiliaryTopicsTest, only_recordings_have_them) {
  EXPECT_EQ(recording_of("synthetic:office"), nullptr);
}

}  // namespace
}  // namespace rtd::camera
