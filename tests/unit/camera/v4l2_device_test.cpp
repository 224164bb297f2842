// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/v4l2_device.hpp"

#include <gmock/gmock.h>

#include "services/camera/devices/usb_access.hpp"
#include "tests/unit/camera/played_kernel.hpp"

namespace rtd::camera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kColor = "/dev/video0";
constexpr const char* kDepth = "/dev/video2";
constexpr std::chrono::milliseconds kAtOnce{0};

class V4l2DeviceTest : public ::testing::Test {
 protected:
  V4l2DeviceTest() {
    nodes_.by_path[kColor] = {};
    nodes_.by_path["/dev/video1"].capabilities = V4L2_CAP_META_CAPTURE;
    nodes_.by_path[kDepth].format = V4L2_PIX_FMT_Z16;
  }
  std::unique_ptr<LiveDevice> device(const std::string& nodes = kColor) {
    return make_v4l2_device(nodes, std::make_unique<test::PlayedKernel>(nodes_));
  }
  std::unique_ptr<LiveDevice> started() {
    auto camera = device();
    camera->open();
    camera->start({320, 240, 30});
    return camera;
  }
  test::PlayedNode& color() { return nodes_.by_path[kColor]; }
  test::PlayedNode& depth() { return nodes_.by_path[kDepth]; }
  /// Problem and message of a camera that cannot be used.
  std::pair<DeviceProblem, std::string> refusal(const std::string& nodes = kColor) {
    try {
      const auto camera = device(nodes);
      camera->open();
      camera->start({});
    } catch (const DeviceError& error) {
      return {error.problem(), error.what()};
    }
    return {DeviceProblem::kEnded, "none"};
  }

  test::PlayedNodes nodes_;
};

TEST_F(V4l2DeviceTest, finds_the_depth_node_of_the_same_camera_and_reads_both) {
  nodes_.by_path["/dev/video1b"] = {.format = V4L2_PIX_FMT_Z16, .bus = "usb-2"};
  const auto camera = started();
  EXPECT_TRUE(color().streaming && depth().streaming);
  EXPECT_FALSE(camera->read(kAtOnce));
  color().image(1.5, 7);
  depth().image(1.502, 3);
  const DeviceImage first = camera->read(kAtOnce).value(), second = camera->read(kAtOnce).value();
  EXPECT_EQ(first.stream, Stream::kColor);
  EXPECT_EQ(first.stamp_ns, 1'500'000'000);
  EXPECT_EQ(first.bytes, std::vector<std::uint8_t>(320 * 240 * 2, 7));
  EXPECT_EQ(second.stream, Stream::kDepth);
  EXPECT_EQ(second.stamp_ns, 1'502'000'000);
}

TEST_F(V4l2DeviceTest, buffers_go_back_to_the_camera) {
  const auto camera = started();
  for (int i = 0; i < 50; ++i) {
    color().image(i, 1);
    ASSERT_TRUE(camera->read(kAtOnce)) << i;
  }
}

TEST_F(V4l2DeviceTest, bytes_behind_rows_are_left_out) {
  color().padding = 64;
  const auto camera = started();
  color().image(1, 9);
  EXPECT_EQ(camera->read(kAtOnce)->bytes.size(), 320U * 240 * 2);
}

TEST_F(V4l2DeviceTest, a_damaged_image_is_left_out) {
  const auto camera = started();
  color().image(1, 9, V4L2_BUF_FLAG_ERROR);
  color().image(2, 9);
  EXPECT_FALSE(camera->read(kAtOnce));
  EXPECT_EQ(camera->read(kAtOnce)->stamp_ns, 2'000'000'000);
}

TEST_F(V4l2DeviceTest, says_why_it_cannot_be_used) {
  color().open_error = EACCES;
  EXPECT_THAT(refusal(), testing::Pair(DeviceProblem::kNoPermission,
                                       AllOf(HasSubstr("group 'video'"), HasSubstr("60-rtd-cameras.rules"))));
  color().open_error = 0;
  color().fails[VIDIOC_S_FMT] = EBUSY;
  EXPECT_THAT(refusal(), testing::Pair(DeviceProblem::kBusy, HasSubstr("another program uses it")));
  color().fails = {{VIDIOC_STREAMON, ENOSPC}};
  EXPECT_THAT(refusal(), testing::Pair(DeviceProblem::kBandwidth, HasSubstr("USB 3 port")));
  color().fails.clear();
  depth().sizes = {{424, 240}};
  EXPECT_THAT(refusal(), testing::Pair(DeviceProblem::kUnsupportedMode,
                                       AllOf(HasSubstr("640 x 480"), HasSubstr("424 x 240 Z16 15, 30 Hz"))));
  depth().present = false;
  EXPECT_THAT(refusal(), testing::Pair(DeviceProblem::kUnsupportedMode, HasSubstr("no node with Z16")));
  EXPECT_THAT(refusal("/dev/video7"), testing::Pair(DeviceProblem::kAbsent, HasSubstr("not plugged in")));
  EXPECT_THAT(refusal("/dev/video1"), testing::Pair(DeviceProblem::kUnsupportedMode, HasSubstr("does not capture")));
  EXPECT_EQ(nodes_.open_now, 0);
  EXPECT_EQ(nodes_.mapped_now, 0);
}

TEST_F(V4l2DeviceTest, unplugged_fifty_times_leaks_neither_descriptors_nor_buffers) {
  const auto camera = device();
  for (int i = 0; i < 50; ++i) {
    camera->open();
    camera->start({});
    color().present = depth().present = false;
    try {
      camera->read(kAtOnce);
      FAIL() << "unplugged";
    } catch (const DeviceError& error) {
      EXPECT_EQ(error.problem(), DeviceProblem::kAbsent);
      EXPECT_THAT(error.what(), HasSubstr("was unplugged"));
    }
    camera->close();
    EXPECT_EQ(nodes_.open_now, 0);
    EXPECT_EQ(nodes_.mapped_now, 0);
    color() = {};
    depth() = {.format = V4L2_PIX_FMT_Z16};
  }
}

TEST_F(V4l2DeviceTest, lists_cameras_by_plug_with_their_modes) {
  nodes_.by_path["/dev/video3"] = {.format = V4L2_PIX_FMT_GREY};  // infrared
  nodes_.by_path["/dev/video4"] = {.card = "Webcam", .bus = "usb-2"};
  nodes_.by_path["/dev/video5"] = {.open_error = EACCES};
  test::PlayedKernel kernel(nodes_);
  const std::vector<FoundCamera> cameras = find_v4l2_cameras(kernel);
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_THAT(cameras[0].problem, HasSubstr("no permission"));
  EXPECT_EQ(cameras[1].uri, "v4l2:/dev/video0,/dev/video2");
  EXPECT_EQ(cameras[1].problem, "");
  EXPECT_EQ(list_modes(cameras[1].modes, Stream::kDepth), "320 x 240 Z16 15, 30 Hz; 640 x 480 Z16 15, 30 Hz");
  EXPECT_EQ(cameras[2].name, "Webcam");
  EXPECT_THAT(cameras[2].problem, HasSubstr("no depth"));
}

TEST(UsbAccessTest, finds_the_file_of_a_usb_device) {
  EXPECT_EQ(usb_node("1d27/0609@1/5"), "/dev/bus/usb/001/005");
  EXPECT_EQ(usb_node("2bc5/0401@12/113"), "/dev/bus/usb/012/113");
  EXPECT_EQ(usb_node("walk.oni"), std::nullopt);
  EXPECT_EQ(usb_node("1d27/0609@1/5x"), std::nullopt);
}

}  // namespace
}  // namespace rtd::camera
