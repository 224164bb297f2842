// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/realsense/realsense_device.hpp"
#include "tests/component/camera/camera_on_bus.hpp"
#include "tests/support/realsense_double.hpp"

namespace rtd::camera {
namespace {

using test::RealsenseDouble;

constexpr int kRealsenseWidth = 64, kRealsenseHeight = 48;

class RealsenseCamera : public test::CameraOnBus {
 protected:
  RealsenseCamera() : CameraOnBus("realsense-dds:") {}
};

TEST_P(RealsenseCamera, plays_a_device_and_registers_its_depth) {
  config_.source = "realsense-dds:?width=64&height=48";
  const RealsenseDouble device(options_, {});
  auto running = start();
  ASSERT_TRUE(frames_come(10));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  const auto frame = frames_.all().back();
  EXPECT_EQ(frame->width, std::uint32_t{kRealsenseWidth});
  EXPECT_EQ(frame->color_bgr[100], 77);
  EXPECT_DOUBLE_EQ(frame->intrinsics[0], 60);
  EXPECT_NEAR(frame->depth_scale_m, 0.002, 1e-9) << "the device's own unit";
  EXPECT_EQ(frame->depth[kRealsenseWidth * kRealsenseHeight / 2 + kRealsenseWidth / 2], 257 + 50)
      << "0.1 m in front of colour";
  EXPECT_EQ(frame->depth[0], 0) << "the colour camera sees more than the depth camera";
}

TEST_P(RealsenseCamera, asks_the_device_for_the_size_and_scales_its_calibration) {
  config_.source = "realsense-dds:1234?width=128&height=96";
  const RealsenseDouble device(options_, {});
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
  RealsenseDouble device(options_, {});
  device.refuse_requests();
  auto running = start();
  ASSERT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
  EXPECT_EQ(frames_.all().back()->width, std::uint32_t{kRealsenseWidth});
}

TEST_P(RealsenseCamera, waits_for_a_device_and_survives_that_it_goes_and_comes) {
  auto running = start();
  EXPECT_TRUE(said(msg::ServiceState::kStarting, "no RealSense device announces itself"));
  auto device = std::make_unique<RealsenseDouble>(options_, test::RealsenseScript{});
  EXPECT_TRUE(frames_come());
  device.reset();
  EXPECT_TRUE(said(msg::ServiceState::kDegraded, "was unplugged"));
  device = std::make_unique<RealsenseDouble>(options_, test::RealsenseScript{});
  EXPECT_TRUE(frames_come());
  device->announce_stop();
  EXPECT_TRUE(statuses_.wait([](const auto& all) { return all.back()->state == msg::ServiceState::kDegraded; }));
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_P(RealsenseCamera, needs_a_serial_where_there_are_several) {
  const RealsenseDouble first(options_, {}), second(options_, {.serial = "5678"});
  EXPECT_EQ(run(), service::kRunFailed);
  EXPECT_TRUE(said(msg::ServiceState::kFailed, "2 RealSense devices are in DDS domain"));
  config_.source = "realsense-dds:5678";
  auto running = start();
  EXPECT_TRUE(frames_come());
  stop_.request_stop();
  EXPECT_EQ(running.get(), service::kOk);
}

TEST_P(RealsenseCamera, devices_are_found_with_their_modes) {
  const RealsenseDouble device(options_, {});
  const std::vector<FoundCamera> cameras = find_realsense_cameras(options_);
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].uri, "realsense-dds:1234");
  EXPECT_EQ(cameras[0].problem, "");
  EXPECT_EQ(list_modes(cameras[0].modes, Stream::kColor), "64 x 48 RGB8 30 Hz; 128 x 96 RGB8 30 Hz");
}

INSTANTIATE_TEST_SUITE_P(EachVendor, RealsenseCamera, ::testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RealsenseCamera);

}  // namespace
}  // namespace rtd::camera
