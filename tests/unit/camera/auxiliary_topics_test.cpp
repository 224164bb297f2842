// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/auxiliary_topics.hpp"

#include <gmock/gmock.h>

#include "common/camera/source_factory.hpp"
#include "common/msg/imu.hpp"
#include "tests/unit/camera/mcap_file.hpp"

namespace rtd::camera {
namespace {

using test::McapFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

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
