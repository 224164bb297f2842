// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/openni2/openni2_device.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/camera/frame_source.hpp"
#include "services/camera/live_camera.hpp"
#include "tests/support/oni_writer.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::camera {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kFrames = 20, kOpenNiWidth = 320, kOpenNiHeight = 240;
constexpr std::uint64_t kPeriodUs = 33'333;

class OpenNi2DeviceTest : public ::testing::Test {
 protected:
  /// Frame i is of colour (10 + i, 20, 30) RGB and of depth 1000 + i mm, 5 ms later.
  void record(double horizontal_fov_rad = 1.0, double vertical_fov_rad = 0.8) const {
    rtd::test::OniWriter writer(file_, {kOpenNiWidth, kOpenNiHeight}, 30, horizontal_fov_rad, vertical_fov_rad);
    for (int i = 1; i <= kFrames; ++i) {
      const std::uint64_t stamp_us = kPeriodUs * static_cast<std::uint64_t>(i);
      writer.color(stamp_us, cv::Mat(kOpenNiHeight, kOpenNiWidth, CV_8UC3, cv::Scalar(10 + i, 20, 30)));
      writer.depth(stamp_us + 5000, cv::Mat(kOpenNiHeight, kOpenNiWidth, CV_16UC1, cv::Scalar(1000 + i)));
    }
  }
  std::unique_ptr<FrameSource> source(const std::string& parameters = {}) const {
    return make_live_source("openni2:" + file_.string() + parameters, {}, 5'000'000'000, [](const std::string&) {});
  }

  const rtd::test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "walk.oni";
};

TEST_F(OpenNi2DeviceTest, plays_every_frame_of_an_oni_file_once) {
  record();
  const auto played = source();
  ASSERT_TRUE(played->open());
  for (int i = 1; i <= kFrames; ++i) {
    const std::optional<SourceFrame> frame = played->next();
    ASSERT_TRUE(frame) << i;
    EXPECT_EQ(frame->image.seq, static_cast<std::uint64_t>(i - 1));
    EXPECT_EQ(frame->image.stamp_ns, static_cast<std::int64_t>(kPeriodUs) * i * 1000);
    EXPECT_EQ(frame->image.color_bgr.at<cv::Vec3b>(9, 9), cv::Vec3b(30, 20, static_cast<unsigned char>(10 + i)));
    EXPECT_EQ(frame->image.depth.at<std::uint16_t>(9, 9), 1000 + i);
    EXPECT_NEAR(frame->image.depth_offset_s, 0.005, 1e-9);
  }
  EXPECT_FALSE(played->next());
  EXPECT_EQ(played->counters().skipped_total(), 0U);
  EXPECT_FALSE(played->info().live);
  EXPECT_DOUBLE_EQ(played->info().depth_scale_m, 0.001);
}

TEST_F(OpenNi2DeviceTest, the_lens_is_that_of_the_field_of_view) {
  record(1.0, 0.8);
  const auto played = source();
  ASSERT_TRUE(played->open());
  const auto& camera = played->info().camera.parameters();
  EXPECT_NEAR(camera.fx, kOpenNiWidth / (2 * std::tan(0.5)), 1e-3);
  EXPECT_NEAR(camera.fy, kOpenNiHeight / (2 * std::tan(0.4)), 1e-3);
  EXPECT_EQ(camera.cx, (kOpenNiWidth - 1) / 2.0);
}

TEST_F(OpenNi2DeviceTest, without_a_field_of_view_a_calibration_is_asked_for) {
  record(0, 0);
  EXPECT_THAT([&] { source()->open(); }, ThrowsMessage<SourceError>(HasSubstr("?calibration=FILE")));
}

TEST_F(OpenNi2DeviceTest, a_mode_that_the_file_lacks_is_refused_with_those_it_has) {
  record();
  EXPECT_THAT(
      [&] { source("?width=640&height=480")->open(); },
      ThrowsMessage<SourceError>(AllOf(HasSubstr("no colour mode of 640 x 480 px"), HasSubstr("320 x 240 RGB8"))));
}

TEST_F(OpenNi2DeviceTest, a_file_that_ends_early_gives_the_frames_before) {
  record();
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) / 2);
  const auto played = source();
  ASSERT_TRUE(played->open());
  int frames = 0;
  while (played->next()) ++frames;
  EXPECT_GE(frames, kFrames / 2 - 2);
  EXPECT_LE(frames, kFrames / 2);
}

TEST_F(OpenNi2DeviceTest, other_files_and_absent_cameras_are_named) {
  std::ofstream(file_) << "no recording";
  EXPECT_THAT([&] { source()->open(); }, ThrowsMessage<SourceError>(HasSubstr("is not an .oni file")));
  std::filesystem::remove(file_);
  EXPECT_THAT([&] { source()->open(); }, ThrowsMessage<SourceError>(HasSubstr("there is no file")));
  const auto absent = make_live_source("openni2:1d27/0609@1/99", {}, 300'000'000, [](const std::string&) {});
  EXPECT_THAT([&] { absent->open(); }, ThrowsMessage<SourceError>(HasSubstr("no OpenNI2 camera 1d27/0609@1/99")));
}

TEST_F(OpenNi2DeviceTest, opened_and_closed_often_it_leaks_no_descriptor) {
  record();
  const auto descriptors = [] {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
  };
  const auto device = make_openni2_device(parse_device_uri("openni2:" + file_.string()));
  const auto once = [&] {
    device->open();
    device->start({});
    EXPECT_TRUE(device->read(std::chrono::milliseconds(500)));
    device->close();
  };
  once();
  const auto before = descriptors();
  for (int i = 0; i < 12; ++i) once();
  EXPECT_LE(descriptors(), before + 1);
}

}  // namespace
}  // namespace rtd::camera
