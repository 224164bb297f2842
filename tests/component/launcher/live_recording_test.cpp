// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// A recording of a ROS 2 camera is played beside a run that uses it as its camera, as users try a driver's habits.
#include <gmock/gmock.h>

#include "common/camera/source_factory.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"

namespace rtd::launcher {
namespace {

using camera::test::ImageBag;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Three seconds of a room at 30 Hz, whose driver leaves the step of its colour images at 0.
std::string recording_with_step_0() {
  camera::test::McapFile file;
  const auto source = camera::make_source("synthetic:static?frames=90&width=320&height=240");
  source->open();
  while (const auto frame = source->next()) {
    const double stamp_s = 1e-9 * static_cast<double>(frame->image.stamp_ns);
    const auto& lens = source->info().camera.parameters();
    msg::CameraInfo info = ImageBag::camera_info(lens.fx);
    info.width = static_cast<std::uint32_t>(lens.width);
    info.height = static_cast<std::uint32_t>(lens.height);
    info.k = {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
    info.header.stamp = msg::to_time(frame->image.stamp_ns);
    cv::Mat depth_mm;
    frame->image.depth.convertTo(depth_mm, CV_16UC1, 1000 * frame->image.depth_scale_m);
    msg::Image color = ImageBag::image(frame->image.color_bgr, "bgr8", stamp_s);
    color.step = 0;
    file.add("/cam/camera_info", "sensor_msgs/msg/CameraInfo", info, stamp_s);
    file.add("/cam/image_raw", "sensor_msgs/msg/Image", color, stamp_s);
    file.add("/cam/depth", "sensor_msgs/msg/Image", ImageBag::image(depth_mm, "16UC1", stamp_s), stamp_s);
  }
  return file.bytes();
}

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(LiveRecording, with_a_wrong_step_is_tracked_with_one_warning) {
  const ScratchFolder scratch;
  const std::string recording = scratch / "driver.mcap";
  std::ofstream(recording, std::ios::binary) << recording_with_step_0();
  const std::string domain = "93";  // of no other test
  RtdCommand run, replay(std::filesystem::path(RTD_EXECUTABLE).parent_path() / "rtd-replay");
  run.start({"run", "--source", "ros2:/cam/image_raw,/cam/depth", "--frames", "30", "--detector", "off", "--out",
             scratch / "out", "--domain", domain});
  ASSERT_TRUE(run.wait_for("it has no publisher")) << run.output();
  replay.start({recording, "--domain", domain, "--wait-readers", "10"});
  const int exit_code = run.wait();
  if (test_support::kSanitized && exit_code == 3) GTEST_SKIP() << test_support::kTooSlow;  // frames late
  EXPECT_EQ(exit_code, 0) << run.output();
  EXPECT_EQ(replay.wait(), 0) << replay.output();
  EXPECT_THAT(run.output(), AllOf(HasSubstr("30 used, 30 with pose"), HasSubstr("'step' is 0")));
  EXPECT_EQ(occurrences(run.output(), "'step' is 0"), 1U) << run.output();
}

}  // namespace
}  // namespace rtd::launcher
