// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/inertial/motion_feed.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <thread>

#include "common/camera/synthetic/motion_sensors.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/config.hpp"
#include "services/slam/slam_service.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using camera::synthetic::SyntheticImu;
using Eigen::Vector3d;
using test_support::FeatureWorld;
using test_support::Inbox;

/// A slam service with an IMU driver that offers best effort, as ROS 2's sensor data profile.
class MotionFeedTest : public test_support::ServiceFixture<SlamService> {
 protected:
  MotionFeedTest()
      : features_(bus_->writer(bus::topics::kFeatures)),
        raw_(bus::connect_raw(bus_options_)),
        imu_(FeatureWorld::T_world_camera_at, SyntheticImu::Options(), 1) {
    receive(bus::topics::kTracking, results_);
    config_.core = test_support::settled();
    config_.motion.imu = "/camera/imu";
    bus::RawWriterOptions options;
    options.qos.reliable = false;
    options.qos.depth = 64;
    driver_ = raw_->writer({"rt/camera/imu", msg::kImuDdsType}, options);
  }

  void publish(const msg::Imu& imu) {
    const auto bytes = ros::encode<ros::Wire::kCdr>(imu);
    driver_->write(std::as_bytes(std::span(bytes)));
  }
  msg::Imu reading(std::int64_t index) const {
    const camera::ImuReading truth = imu_.reading(index);
    msg::Imu imu;
    imu.header.stamp = msg::to_time(truth.stamp_ns + FeatureWorld::stamp_ns(0));
    imu.angular_velocity = {truth.gyro_rad_s.x(), truth.gyro_rad_s.y(), truth.gyro_rad_s.z()};
    imu.linear_acceleration = {truth.accel_m_s2.x(), truth.accel_m_s2.y(), truth.accel_m_s2.z()};
    return imu;
  }
  /// One frame of lockstep: samples up to its stamp, the frame, its result.
  void step(const msg::FeatureFrame& view) {
    while (static_cast<double>(next_) / 200 < static_cast<double>(view.seq) / 30 + 0.005) publish(reading(next_++));
    const std::size_t before = results_.all().size();
    ASSERT_TRUE(features_.write(view));
    ASSERT_TRUE(results_.wait_count(before + 1)) << "no result for frame " << view.seq;
  }
  void step(std::uint64_t seq, bool covered) {
    auto view = world_.view(seq);
    for (std::uint32_t i = 0; covered && i < view->count; ++i) view->features[i].flags = msg::kFeatureRemoved;
    step(*view);
  }

  const FeatureWorld world_ = FeatureWorld::noisy();
  Inbox<msg::TrackingResult> results_;
  bus::Writer<msg::FeatureFrame> features_;
  std::shared_ptr<bus::RawBus> raw_;
  std::unique_ptr<bus::RawWriter> driver_;
  SyntheticImu imu_;
  std::int64_t next_ = 0;
};

TEST_F(MotionFeedTest, pose_continues_by_the_topic_of_a_best_effort_driver) {
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 60; ++seq) step(seq, false);
  for (std::uint64_t seq = 60; seq < 105; ++seq) step(seq, true);
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kPredicted) << "1.5 s without a view";
  EXPECT_TRUE(wait_metric("frames_predicted", 45));
  EXPECT_TRUE(wait_metric("imu_dropped", 0));
  EXPECT_TRUE(wait_metric("imu_ready", 1));
}

std::string text_of(const Eigen::Isometry3d& mount) {
  const Eigen::Quaterniond q(mount.linear());
  std::ostringstream text;
  text << mount.translation().transpose().format(Eigen::IOFormat(Eigen::FullPrecision, 0, ",", ",")) << ',' << q.x()
       << ',' << q.y() << ',' << q.z() << ',' << q.w();
  return text.str();
}

/// The camera looks 20 degrees down from a robot that stands on a slope of 6 degrees.
TEST_F(MotionFeedTest, the_map_of_a_robot_on_a_slope_has_z_up_by_gravity) {
  const auto turn = [](double deg, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(deg * std::numbers::pi / 180, axis);
  };
  const Eigen::Isometry3d T_base_camera = camera::synthetic::T_base_level_camera(0.8) * turn(-20, Vector3d::UnitX());
  const Eigen::Isometry3d T_level_base(turn(6, Vector3d(1, 2, 0).normalized()));
  const Eigen::Isometry3d T_level_camera = T_level_base * T_base_camera;
  imu_ = SyntheticImu([T_level_camera](double /*t_s*/) { return T_level_camera; }, SyntheticImu::Options(), 1);
  config_.base.gravity = "imu";
  config_.base.camera = text_of(T_base_camera);
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 25; ++seq) step(*world_.view(seq, Eigen::Isometry3d::Identity()));
  const auto results = results_.all();
  EXPECT_EQ(results.front()->state, msg::TrackingState::kInitializing) << "half a second of rest shows gravity";
  ASSERT_EQ(results.back()->state, msg::TrackingState::kOk);
  const Eigen::Isometry3d T_map_camera = msg::to_isometry(results.back()->T_world_camera);
  const Eigen::Isometry3d T_map_base = T_map_camera * T_base_camera.inverse();
  const auto degrees = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::acos(std::min(1.0, a.dot(b))) * 180 / std::numbers::pi;
  };
  const Eigen::Vector3d up_camera = T_map_camera.linear().transpose() * Vector3d::UnitZ();
  EXPECT_LT(degrees(up_camera, T_level_camera.linear().transpose() * Vector3d::UnitZ()), 1) << "the map is level";
  EXPECT_NEAR(degrees(T_map_base.linear().col(2), Vector3d::UnitZ()), 6, 1) << "the base stands on the slope";
  EXPECT_LT(T_map_base.translation().norm(), 0.02) << "m: the map begins at the base";
  EXPECT_TRUE(wait_metric("map_z_up", 1));
}

TEST_F(MotionFeedTest, counts_what_it_cannot_use) {
  start(service::Pace::kLockstep);
  for (int i = 0; i < 1000 && driver_->matched() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_GT(driver_->matched(), 0) << "what is sent before is lost to the service";
  step(0, false);
  msg::Imu broken = reading(next_);
  broken.angular_velocity.x = std::numeric_limits<double>::quiet_NaN();
  publish(broken);
  publish(reading(next_ - 1));  // again
  publish(reading(0));          // late
  const std::array<std::byte, 6> torn{std::byte{0}, std::byte{1}};
  driver_->write(torn);
  for (std::uint64_t seq = 1; seq < 5; ++seq) step(seq, false);
  EXPECT_TRUE(wait_metric("imu_dropped", 4));
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kOk);
}

TEST_F(MotionFeedTest, a_silent_topic_is_named_and_delays_no_frame) {
  driver_.reset();
  config_.motion.imu = "/nowhere/imu";
  start(service::Pace::kLockstep);
  const auto before = std::chrono::steady_clock::now();
  for (std::uint64_t seq = 0; seq < 20; ++seq) {
    const std::size_t count = results_.all().size();
    ASSERT_TRUE(features_.write(*world_.view(seq)));
    ASSERT_TRUE(results_.wait_count(count + 1));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(4)) << "20 times 250 ms would be 5 s";
  EXPECT_TRUE(wait_state(msg::ServiceState::kDegraded, "no message on /nowhere/imu"));
}

TEST(MotionTopics, are_checked_with_a_reason) {
  const auto refused = [](const MotionTopics& motion, bool with_base = false) -> std::string {
    ServiceConfig config;
    config.motion = motion;
    if (with_base) config.base.camera = "0,0,1,-0.5,0.5,-0.5,0.5";
    try {
      config.validate();
    } catch (const service::ConfigError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(refused({.imu = "/imu/data"}), "");
  EXPECT_EQ(refused({.imu = "/imu/data", .wheels = "/odom", .imu_mount_in_base = "0,0,0,0,0,0,1"}, true), "");
  EXPECT_THAT(refused({.imu = "imu/data"}), ::testing::HasSubstr("/imu/data"));
  EXPECT_THAT(refused({.wheels = "/odom"}), ::testing::HasSubstr("--camera-in-base"));
  EXPECT_THAT(refused({.imu = "/imu/data", .imu_mount = "1,2,3"}), ::testing::HasSubstr("slam.imu.mount=1,2,3"));
  EXPECT_THAT(refused({.imu = "/imu/data", .imu_mount_in_base = "0,0,0,0,0,0,1"}),
              ::testing::HasSubstr("--camera-in-base"));
}

}  // namespace
}  // namespace rtd::slam
