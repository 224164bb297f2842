// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/motion_sensors.hpp"

#include <gmock/gmock.h>

#include "common/camera/open/source_factory.hpp"

namespace rtd::camera {
namespace {

std::vector<SourceFrame> frames_of(const std::string& uri) {
  const auto source = make_source(uri);
  std::vector<SourceFrame> frames;
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  return frames;
}

TEST(MotionSensors, readings_reach_from_frame_to_frame_without_a_gap) {
  const std::string uri = "synthetic:static?frames=5&width=64&height=48&imu=1&wheel=1&motion=driving";
  EXPECT_TRUE(make_source(uri)->info().has_imu && make_source(uri)->info().has_wheels);
  const std::vector<SourceFrame> frames = frames_of(uri), again = frames_of(uri);
  std::int64_t imu_ns = 0, wheel_ns = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_FALSE(frames[i].imu.empty() || frames[i].wheels.empty());
    for (const ImuReading& reading : frames[i].imu) {
      EXPECT_TRUE(imu_ns == 0 || reading.stamp_ns - imu_ns == 5'000'000);
      imu_ns = reading.stamp_ns;
    }
    for (const WheelReading& reading : frames[i].wheels) {
      EXPECT_TRUE(wheel_ns == 0 || reading.stamp_ns - wheel_ns == 20'000'000);
      wheel_ns = reading.stamp_ns;
    }
    EXPECT_GE(imu_ns + 2000, frames[i].image.stamp_ns);
    EXPECT_GE(wheel_ns + 2000, frames[i].image.stamp_ns);
    EXPECT_LT(imu_ns, frames[i].image.stamp_ns + 5'000'000);
    EXPECT_EQ(frames[i].imu.back().gyro_rad_s, again[i].imu.back().gyro_rad_s) << "another run, another reading";
  }
}

TEST(MotionSensors, at_rest_show_gravity_and_their_biases) {
  const std::vector<SourceFrame> frames = frames_of("synthetic:static?frames=60&width=64&height=48&imu=1&motion=fixed");
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
  double count = 0;
  for (const SourceFrame& frame : frames) {
    for (const ImuReading& reading : frame.imu) {
      gyro += reading.gyro_rad_s;
      accel += reading.accel_m_s2;
      ++count;
    }
  }
  EXPECT_NEAR((gyro / count).norm(), 0.0087, 0.001) << "0.5 degrees/s";
  const Eigen::Vector3d up = frames[0].T_world_camera->linear().transpose() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR((accel / count - 9.80665 * up).norm(), 0.05, 0.01);
}

TEST(MotionSensors, wheels_follow_the_base_with_a_small_error) {
  const std::vector<SourceFrame> frames =
      frames_of("synthetic:static?frames=60&fps=10&width=64&height=48&wheel=1&motion=driving");
  const Eigen::Isometry3d T_base_camera = synthetic::T_base_level_camera(0);
  const Eigen::Isometry3d T_first_last = T_base_camera * frames.front().T_world_camera->inverse() *
                                         *frames.back().T_world_camera * T_base_camera.inverse();
  const WheelReading &first = frames.front().wheels.back(), &last = frames.back().wheels.back();
  const Eigen::Isometry3d T_wheels = first.T_odom_base.inverse() * last.T_odom_base;
  EXPECT_GT(T_first_last.translation().norm(), 0.2);
  EXPECT_LT((T_wheels.translation() - T_first_last.translation()).norm(), 0.1);
  EXPECT_GT((T_wheels.translation() - T_first_last.translation()).norm(), 1e-4) << "wheels are never exact";
  EXPECT_NEAR(T_wheels.translation().z(), 0, 1e-9);
}

TEST(MotionSensors, wheels_need_a_camera_that_drives) {
  try {
    make_source("synthetic:static?wheel=1");
    FAIL() << "accepted";
  } catch (const SourceError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("motion=driving"));
  }
}

TEST(Darkness, leaves_an_image_without_contrast) {
  const std::vector<SourceFrame> frames =
      frames_of("synthetic:static?frames=40&fps=10&width=64&height=48&dark_from=1&dark=2");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    double most = 0;
    cv::minMaxLoc(frames[i].image.color_bgr.reshape(1), nullptr, &most);
    EXPECT_EQ(most < 10, i >= 10 && i < 30) << "frame " << i;
    EXPECT_TRUE(frames[i].imu.empty());
  }
}

}  // namespace
}  // namespace rtd::camera
