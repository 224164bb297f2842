// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/camera_frame.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace rtd::service {
namespace {

constexpr const char* kUsual = "camera_color_optical_frame";

class CameraFrame : public testing::Test {
 protected:
  static std::shared_ptr<bus::Bus> join() {
    bus::BusOptions options;
    options.vendor = bus::inprocess::vendor();
    options.robot = "anna";
    return bus::connect(options);
  }
  bool wait_known() const {
    for (int i = 0; i < 1000 && !knows_camera_frame(slam_); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return knows_camera_frame(slam_);
  }

  StopToken stop_;
  const std::shared_ptr<bus::Bus> of_slam_ = join(), of_camera_ = join();
  Heartbeat slam_{*of_slam_, "slam", stop_}, camera_{*of_camera_, "camera", stop_};
};

TEST_F(CameraFrame, is_the_usual_one_of_the_robot_until_a_camera_names_it) {
  EXPECT_FALSE(knows_camera_frame(slam_));
  EXPECT_EQ(camera_frame(slam_, *of_slam_), std::string("anna/") + kUsual);
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, "astra_rgb_optical_frame"), "astra_rgb_optical_frame");
  ASSERT_TRUE(wait_known());
  EXPECT_EQ(camera_frame(slam_, *of_slam_), "astra_rgb_optical_frame") << "as its driver has it in tf";
  EXPECT_EQ(camera_frame(slam_, *of_slam_, "lens"), "anna/lens") << "the setting wins";
}

TEST_F(CameraFrame, that_a_heartbeat_cannot_carry_becomes_the_usual_one) {
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, "my camera"), std::string("anna/") + kUsual);
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, ""), std::string("anna/") + kUsual);
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, std::string(300, 'x')), std::string("anna/") + kUsual);
}

}  // namespace
}  // namespace rtd::service
