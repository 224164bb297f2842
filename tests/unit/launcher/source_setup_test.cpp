// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What a recorded source brings beside its frames: IMU, wheels and transforms of robots that others drove.
#include <gmock/gmock.h>

#include "common/msg/imu.hpp"
#include "services/launcher/run/run_setup.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"

namespace rtd::launcher {
namespace {

using camera::test::ImageBag;
using camera::test::McapFile;
using namespace ::testing;

msg::Imu imu() {
  msg::Imu sample;
  sample.header = {msg::to_time(1'000'000'000), "imu"};
  return sample;
}

msg::TFMessage camera_on_base() {
  msg::TransformStamped transform;
  transform.header.frame_id = "base_link";
  transform.child_frame_id = "camera_color_optical_frame";
  return {{transform}};
}

class RobotRecording : public ::testing::Test {
 protected:
  RobotRecording() {
    file_.add("/camera/color/image_raw", "sensor_msgs/msg/Image", ImageBag::image(ImageBag::color(), "bgr8", 1), 1);
    file_.add("/camera/aligned_depth_to_color/image_raw", "sensor_msgs/msg/Image",
              ImageBag::image(ImageBag::depth(), "16UC1", 1), 1);
    file_.add("/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), 1);
  }
  void add_imu() { file_.add("/camera/imu", "sensor_msgs/msg/Imu", imu(), 1.0); }
  void add_wheels() { file_.add("/odom", "nav_msgs/msg/Odometry", msg::Odometry{}, 1.0); }

  /// What the run takes from the source.
  std::vector<std::string> beside(const std::string& source) {
    RunSetup setup{RunOptions{}};
    setup.source = source;
    setup.services.motion = motion_;
    setup.services.base.camera = camera_in_base_;
    look_at_source(setup);
    return setup.sensor_topics;
  }
  std::vector<std::string> beside() { return beside(file_.uri()); }

  McapFile file_;
  service::MotionTopics motion_;
  std::string camera_in_base_;
};

TEST_F(RobotRecording, brings_imu_and_wheels_when_they_are_asked_for) {
  add_imu();
  add_wheels();
  motion_ = {.imu = "/camera/imu", .wheels = "/odom"};
  EXPECT_THAT(beside(), ElementsAre("/camera/imu", "/odom"));
}

TEST_F(RobotRecording, brings_nothing_that_is_not_asked_for) {
  add_imu();
  EXPECT_THAT(beside(), IsEmpty());
}

TEST_F(RobotRecording, without_wheels_is_refused_with_the_topics_it_has) {
  add_imu();
  motion_.wheels = "/odom";
  EXPECT_THAT([this] { beside(); },
              ThrowsMessage<service::ConfigError>(
                  AllOf(HasSubstr("--wheel-odometry /odom"), HasSubstr("/camera/imu (sensor_msgs/Imu"))));
}

TEST_F(RobotRecording, whose_topic_is_of_another_type_is_refused_with_its_type) {
  add_wheels();
  motion_.imu = "/odom";
  EXPECT_THAT([this] { beside(); }, ThrowsMessage<service::ConfigError>(
                                        AllOf(HasSubstr("--imu /odom"), HasSubstr("no sensor_msgs/Imu on this topic"),
                                              HasSubstr("/odom (nav_msgs/Odometry"))));
}

TEST_F(RobotRecording, with_tf_alone_has_the_mount_of_the_camera) {
  file_.add("/tf", "tf2_msgs/msg/TFMessage", camera_on_base(), 1.0);
  camera_in_base_ = "tf";
  EXPECT_THAT(beside(), ElementsAre("/tf_static"));
}

TEST_F(RobotRecording, without_transforms_is_refused_when_the_mount_is_to_come_from_them) {
  camera_in_base_ = "tf";
  EXPECT_THAT([this] { beside(); }, ThrowsMessage<service::ConfigError>(
                                        AllOf(HasSubstr("--camera-in-base tf"), HasSubstr("/tf_static or /tf"))));
}

TEST_F(RobotRecording, as_a_bag_of_ros_1_brings_its_imu) {
  ImageBag bag;
  bag.three_frames();
  bag.add("/imu", "sensor_msgs/Imu", imu(), 1.0);
  motion_.imu = "/imu";
  EXPECT_THAT(beside(bag.uri()), ElementsAre("/imu"));
}

}  // namespace
}  // namespace rtd::launcher
