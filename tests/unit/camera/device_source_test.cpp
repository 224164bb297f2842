// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/live/device_source.hpp"

#include <gmock/gmock.h>

#include "common/camera/live_uri.hpp"
#include "common/camera/open/source_factory.hpp"
#include "services/camera/core/live/device_modes.hpp"
#include "tests/unit/camera/played_device.hpp"

namespace rtd::camera {
namespace {

using namespace ::testing;

constexpr std::int64_t kSecondNs = 1'000'000'000;

class DeviceSourceTest : public ::testing::Test {
 protected:
  std::unique_ptr<DeviceSource> source(const std::string& uri = "openni2:1d27/0609@1/9") {
    DeviceOptions options;
    options.uri = parse_device_uri(uri);
    options.on_wait = [this](const std::string& what) { reports_.push_back(what); };
    return std::make_unique<DeviceSource>(std::make_unique<test::PlayedDevice>(script_, time_),
                                          std::make_unique<test::PlayedClock>(time_), options);
  }
  std::unique_ptr<DeviceSource> opened() {
    auto played = source();
    EXPECT_TRUE(played->open());
    return played;
  }
  /// Plays so many seconds of the device's time; the stamps of the frames.
  std::vector<std::int64_t> play(DeviceSource& source, double seconds) {
    const std::int64_t until_ns = time_.now_ns + static_cast<std::int64_t>(seconds * 1e9);
    std::vector<std::int64_t> stamps_ns;
    while (time_.now_ns < until_ns) {
      const std::optional<SourceFrame> frame = source.next();
      if (!frame) break;
      stamps_ns.push_back(frame->image.stamp_ns);
    }
    return stamps_ns;
  }
  /// The first time that something was reported since the last call.
  std::string report() {
    const std::string first = reports_.empty() ? std::string() : reports_.front();
    reports_.clear();
    return first;
  }

  test::DeviceScript script_;
  test::PlayedTime time_;
  std::int64_t plugged_in_ns_ = 0;
  std::vector<std::string> reports_;
};

TEST_F(DeviceSourceTest, frames_have_the_time_of_the_host_and_the_differences_of_the_device) {
  script_.clock_ns = -990 * kSecondNs;
  script_.depth_lag_ns = 9'000'000;
  const auto played = opened();
  const SourceFrame first = played->next().value(), second = played->next().value();
  EXPECT_EQ(first.image.seq, 0U);
  EXPECT_LT(std::abs(first.image.stamp_ns - time_.now_ns), kSecondNs / 10);
  EXPECT_EQ(second.image.stamp_ns - first.image.stamp_ns, test::PlayedDevice::kPeriodNs);
  EXPECT_NEAR(first.image.depth_offset_s, 0.009, 1e-9);
  EXPECT_EQ(first.image.depth.at<std::uint16_t>(3, 3), 1500);
  EXPECT_EQ(played->info().camera.parameters().fx, 30);
  EXPECT_TRUE(played->info().live);
  EXPECT_THAT(reports_, IsEmpty());
}

TEST_F(DeviceSourceTest, fifty_times_unplugged_it_is_back_within_two_seconds_and_leaks_nothing) {
  const auto played = opened();
  std::int64_t last_ns = 0;
  for (int round = 0; round < 50; ++round) {
    for (const std::int64_t stamp_ns : play(*played, 0.5)) {
      ASSERT_GT(stamp_ns, last_ns);
      last_ns = stamp_ns;
    }
    EXPECT_EQ(script_.open_now, 1);
    script_.plugged = false;
    script_.clock_ns = -time_.now_ns;  // begins at zero again
    time_.after(0.1 + 0.37 * (round % 9), [this] {
      EXPECT_EQ(script_.open_now, 0) << "unplugged";
      script_.plugged = true;
      plugged_in_ns_ = time_.now_ns;
    });
    const SourceFrame frame = played->next().value();
    EXPECT_GT(frame.image.stamp_ns, last_ns);
    EXPECT_LT(time_.now_ns - plugged_in_ns_, 2 * kSecondNs);
    EXPECT_THAT(report(), HasSubstr("unplugged")) << round;
  }
  EXPECT_EQ(played->counters().reconnects, 50U);
  EXPECT_EQ(script_.opened, 51);
  EXPECT_EQ(script_.closed, 50);
}

TEST_F(DeviceSourceTest, the_end_of_a_fault_is_reported) {
  const auto played = opened();
  script_.plugged = false;
  time_.after(3, [this] { script_.plugged = true; });
  play(*played, 5);
  EXPECT_GE(reports_.size(), 3U) << "once a second";
  EXPECT_THAT(reports_.front(), HasSubstr("unplugged"));
  EXPECT_THAT(reports_.back(), IsEmpty());
}

TEST_F(DeviceSourceTest, a_silent_stream_is_reported_after_a_second_and_the_device_started_again) {
  for (bool* const stream : {&script_.gives_color, &script_.gives_depth}) {
    const auto played = opened();
    const int opened_before = script_.opened;
    reports_.clear();
    *stream = false;
    std::int64_t reported_ns = 0;
    time_.after(1.3, [&] {
      EXPECT_THAT(report(), HasSubstr(stream == &script_.gives_color ? "no colour image" : "no depth image"));
      reported_ns = time_.now_ns;
    });
    time_.after(2.0, [stream] { *stream = true; });
    played->next();
    EXPECT_GT(reported_ns, 0);
    EXPECT_GT(script_.opened, opened_before);
  }
}

TEST_F(DeviceSourceTest, stamps_that_jump_are_reported_and_frames_go_on) {
  const auto played = opened();
  std::int64_t last_ns = 0;
  for (const std::int64_t jump_ns : {-20 * kSecondNs, 3600 * kSecondNs, -2 * kSecondNs}) {
    script_.clock_ns += jump_ns;
    for (const std::int64_t stamp_ns : play(*played, 2)) {
      ASSERT_GT(stamp_ns, last_ns);
      ASSERT_LT(std::abs(stamp_ns - time_.now_ns), 3 * kSecondNs);
      last_ns = stamp_ns;
    }
    EXPECT_THAT(report(), AllOf(HasSubstr("jumped by"), HasSubstr(jump_ns < 0 ? "-" : " ")));
  }
  EXPECT_EQ(script_.opened, 1);
}

TEST_F(DeviceSourceTest, depth_without_measurements_is_reported_and_its_frames_are_given) {
  const auto played = opened();
  script_.depth_units = 0;
  EXPECT_GT(play(*played, 3).size(), 80U);
  EXPECT_THAT(report(), HasSubstr("no pixel of the depth image"));
  EXPECT_GT(played->counters().frames_without_depth, 80U);
  script_.depth_units = 900;
  reports_.push_back("fault");
  play(*played, 0.2);
  EXPECT_THAT(reports_.back(), IsEmpty());
}

TEST_F(DeviceSourceTest, frames_of_a_frozen_colour_image_are_left_out) {
  const auto played = opened();
  script_.frozen = true;
  time_.after(4, [this] { script_.frozen = false; });
  const std::size_t frames = play(*played, 5).size();
  EXPECT_THAT(report(), HasSubstr("the same to the bit"));
  EXPECT_NEAR(static_cast<double>(frames), 60, 8) << "the first and the last second";
  EXPECT_NEAR(static_cast<double>(played->counters().of(SkipReason::kColorFrozen)), 90, 8);
  EXPECT_EQ(script_.opened, 1);
}

TEST_F(DeviceSourceTest, half_of_the_frames_lost_is_reported_with_both_rates) {
  const auto played = opened();
  play(*played, 5);
  EXPECT_THAT(reports_, IsEmpty());
  script_.every = 2;
  play(*played, 5);
  EXPECT_THAT(report(), AllOf(HasSubstr(" of 30 frames/s"), HasSubstr("USB 3"), HasSubstr("light")));
}

TEST_F(DeviceSourceTest, streams_that_do_not_pair_are_reported) {
  script_.depth_lag_ns = 60'000'000'000;
  EXPECT_THAT([&] { source()->open(); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("no frame within 30 s"), HasSubstr("tolerance_ms"))));
}

TEST_F(DeviceSourceTest, waits_for_a_camera_that_is_not_there_and_refuses_one_that_cannot_be_used) {
  script_.plugged = false;
  EXPECT_THAT([&] { source()->open(); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("no frame within 30 s"), HasSubstr("unplugged"))));
  time_.after(12, [this] { script_.plugged = true; });
  EXPECT_TRUE(source()->open());
  for (const DeviceProblem problem : {DeviceProblem::kBusy, DeviceProblem::kNoPermission, DeviceProblem::kBandwidth}) {
    script_.fails_to_open = DeviceError(problem, "the cause");
    EXPECT_THAT([&] { source()->open(); }, ThrowsMessage<SourceError>("the cause"));
  }
  EXPECT_EQ(script_.open_now, 0);
}

TEST_F(DeviceSourceTest, another_size_before_the_first_frame_is_taken_over) {
  script_.gives_color = script_.gives_depth = false;
  time_.after(2, [this] { script_.size_px = {16, 12}; });  // it is started again after 3 s
  time_.after(4, [this] { script_.gives_color = script_.gives_depth = true; });
  EXPECT_EQ(opened()->info().camera.parameters().width, 16);
  EXPECT_GE(script_.opened, 2);
}

TEST_F(DeviceSourceTest, a_camera_that_is_busy_when_it_comes_back_is_waited_for) {
  const auto played = opened();
  script_.plugged = false;
  time_.after(1, [this] {
    script_.plugged = true;
    script_.fails_to_open = DeviceError(DeviceProblem::kBusy, "another program has it");
  });
  time_.after(3, [this] { script_.fails_to_open.reset(); });
  EXPECT_TRUE(played->next());
  EXPECT_THAT(reports_, ::testing::Contains("another program has it"));
}

TEST_F(DeviceSourceTest, refuses_modes_sizes_and_lenses_that_cannot_be_used) {
  const auto refusal = [this](const std::string& uri, const char* text) {
    EXPECT_THAT([&] { source(uri)->open(); }, ThrowsMessage<SourceError>(HasSubstr(text))) << uri;
  };
  refusal("openni2:1d27/0609@1/9?width=640", "no colour mode of 640 x any px that can be used");
  refusal("openni2:1d27/0609@1/9?fps=60", "it has: 32 x 24 BGR8 30 Hz");
  script_.knows_lens = false;
  refusal("openni2:1d27/0609@1/9", "?calibration=FILE");
  script_.size_px = {4096, 2160};
  refusal("openni2:1d27/0609@1/9", "it has: 4096 x 2160 BGR8 30 Hz");
}

TEST_F(DeviceSourceTest, another_camera_in_its_place_is_refused_until_the_first_is_back) {
  const auto played = opened();
  script_.plugged = false;
  time_.after(1, [this] {
    script_.plugged = true;
    script_.size_px = {16, 12};
  });
  time_.after(3, [this] { script_.size_px = {32, 24}; });
  EXPECT_TRUE(played->next());
  EXPECT_THAT(reports_, ::testing::Contains(HasSubstr("came back with images of 16 x 12 px, not 32 x 24")));
}

TEST_F(DeviceSourceTest, a_stop_ends_waiting) {
  script_.plugged = false;
  const auto waiting = source();
  time_.after(2, [&] { waiting->stop(); });
  EXPECT_FALSE(waiting->open());
  EXPECT_FALSE(waiting->next());
}

TEST(DeviceTimelineTest, follows_a_clock_that_runs_fast_without_a_jump) {
  DeviceTimeline timeline;
  constexpr std::int64_t kPeriodNs = 33'333'333;
  std::int64_t last_ns = -1;
  for (std::int64_t i = 0; i < 30 * 3600; ++i) {  // an hour, 100 ppm fast
    const std::int64_t now_ns = i * kPeriodNs, stamp_ns = now_ns + now_ns / 10'000;
    ASSERT_EQ(timeline.note(stamp_ns, now_ns), 0);
    ASSERT_GT(timeline.host_ns(stamp_ns), last_ns);
    last_ns = timeline.host_ns(stamp_ns);
    ASSERT_NEAR(static_cast<double>(last_ns), static_cast<double>(now_ns), 1e6);
  }
}

TEST(DeviceTimelineTest, late_images_are_no_jump) {
  DeviceTimeline timeline;
  timeline.note(0, 0);
  EXPECT_EQ(timeline.note(33'000'000, 5 * kSecondNs), 0) << "the program was stopped";
  EXPECT_EQ(timeline.host_ns(33'000'000), 33'000'000);
}

TEST(DeviceModesTest, prefer_the_usual_size_and_rate_and_what_costs_least) {
  const auto mode = [](int width, int height, double fps, const char* format) {
    return DeviceMode{Stream::kColor, {width, height}, fps, format};
  };
  const std::vector<DeviceMode> modes = {mode(320, 240, 30, "YUYV"), mode(640, 480, 15, "YUYV"),
                                         mode(640, 480, 30, "MJPG"), mode(640, 480, 30, "YUYV"),
                                         mode(640, 480, 30, "H264"), mode(8000, 6000, 30, "YUYV")};
  EXPECT_EQ(choose_mode(modes, Stream::kColor, {}, "x").format, "YUYV");
  EXPECT_EQ(choose_mode(modes, Stream::kColor, {}, "x").fps, 30);
  EXPECT_EQ(choose_mode(modes, Stream::kColor, {0, 0, 15}, "x").fps, 15);
  EXPECT_EQ(choose_mode(modes, Stream::kColor, {320, 0, 0}, "x").size_px.height, 240);
  EXPECT_EQ(list_modes(modes, Stream::kDepth), "none");
  EXPECT_THAT(list_modes(modes, Stream::kColor), HasSubstr("640 x 480 YUYV 15, 30 Hz"));
  EXPECT_THAT(
      [&] {
        choose_mode(modes, Stream::kColor, {8000, 6000, 0}, "the camera");
      },
      ThrowsMessage<DeviceError>(
          AllOf(HasSubstr("the camera has no colour mode of 8000 x 6000 px"), HasSubstr("8000 x 6000 YUYV 30 Hz"))));
}

TEST(DeviceUriTest, names_device_mode_and_calibration) {
  const DeviceUri uri =
      parse_device_uri("openni2:1d27/0609@1/5?width=320&height=240&fps=60&tolerance_ms=5&calibration=/c.yaml");
  EXPECT_EQ(uri.scheme, "openni2");
  EXPECT_EQ(uri.device, "1d27/0609@1/5");
  EXPECT_EQ(uri.mode.width, 320);
  EXPECT_EQ(uri.mode.fps, 60);
  EXPECT_EQ(uri.tolerance_ns, 5'000'000);
  EXPECT_EQ(uri.calibration_file, "/c.yaml");
  EXPECT_EQ(complete_uri("walk.oni"), "openni2:walk.oni");
  EXPECT_TRUE(is_live("openni2:"));
  for (const char* bad : {"openni2:?width=x", "openni2:?fps=0", "openni2:?tolerance_ms=0", "openni2:?speed=1"})
    EXPECT_THROW(parse_device_uri(bad), SourceError) << bad;
}

TEST(PixelFormatTest, every_colour_format_becomes_bgr) {
  const auto first_pixel = [](const char* format, std::vector<std::uint8_t> bytes) {
    const ImageRead read = decode_image({Stream::kColor, {2, 1}, 30, format}, bytes, "x");
    EXPECT_FALSE(read.problem) << format;
    return read.image.at<cv::Vec3b>(0, 0);
  };
  EXPECT_EQ(first_pixel("RGB8", {1, 2, 3, 4, 5, 6}), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(first_pixel("BGR8", {1, 2, 3, 4, 5, 6}), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(first_pixel("GREY", {9, 8}), cv::Vec3b(9, 9, 9));
  const cv::Vec3b red = first_pixel("YUYV", {81, 90, 81, 240}), same = first_pixel("UYVY", {90, 81, 240, 81});
  EXPECT_GT(red[2], 240);
  EXPECT_LT(red[0], 15);
  EXPECT_EQ(red, same);
}

TEST(PixelFormatTest, wrong_sizes_and_broken_jpegs_are_problems) {
  const DeviceMode depth{Stream::kDepth, {2, 1}, 30, "Z16"}, jpeg{Stream::kColor, {2, 1}, 30, "MJPG"};
  EXPECT_EQ(decode_image(depth, {0xFF, 0xFF, 1, 1}, "x").image.at<std::uint16_t>(0, 0), 0) << "saturated";
  EXPECT_EQ(decode_image(depth, {1, 2, 3}, "x").problem->reason, SkipReason::kDepthUnreadable);
  EXPECT_EQ(decode_image(jpeg, {}, "x").problem->reason, SkipReason::kColorUnreadable);
  EXPECT_EQ(decode_image(jpeg, {0xFF, 0xD8, 0x00}, "x").problem->reason, SkipReason::kColorUnreadable);
}

}  // namespace
}  // namespace rtd::camera
