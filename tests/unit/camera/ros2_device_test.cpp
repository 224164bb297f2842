// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/ros2/ros2_device.hpp"

#include <limits>
#include <tuple>

#include "tests/unit/camera/ros2_device_fixture.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using namespace ::testing;

TEST_F(Ros2DeviceTest, pairs_by_stamp_as_soon_as_both_are_there_and_keeps_the_drivers_calibration) {
  begin();
  color(1.1);
  depth(1.105);
  depth(1.2);
  color(1.2);
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  EXPECT_TRUE(played.info().live);
  EXPECT_EQ(played.info().camera.parameters().fy, 31);
  EXPECT_DOUBLE_EQ(played.info().depth_scale_m, 0.001);
  const SourceFrame first = played.next().value(), second = played.next().value();
  EXPECT_EQ(first.image.seq, 0U);
  EXPECT_EQ(first.image.stamp_ns, 1'100'000'000);
  EXPECT_EQ(second.image.stamp_ns, 1'200'000'000);
  EXPECT_NEAR(first.image.depth_offset_s, 0.005, 1e-9);
  EXPECT_EQ(second.image.depth_offset_s, 0);
  EXPECT_EQ(second.image.depth.at<std::uint16_t>(3, 3), 1500);
  EXPECT_EQ(played.counters().frames, 2U);
  EXPECT_EQ(played.counters().skipped_total(), 0U);
}

/// Flat, or with dots.
cv::Mat infrared(bool dots) {
  cv::Mat grey(24, 32, CV_8UC1, cv::Scalar(90));
  for (int i = 0; i < 24; ++i) grey.at<std::uint8_t>(i, i) = dots ? 250 : 100;
  return grey;
}

TEST_F(Ros2DeviceTest, infrared_with_the_dots_of_an_emitter_that_is_on_in_every_second_image_is_left_out) {
  add("/infra1/info", "sensor_msgs/CameraInfo", ImageBag::camera_info());
  for (int i = 0; i < 30; ++i) {
    add("/infra1/image", "sensor_msgs/Image", ImageBag::image(infrared(i % 2 == 0), "mono8", 1 + i / 30.0));
    depth(1 + i / 30.0);
  }
  DeviceSource played = source("ros2:/infra1/image,/d,/infra1/info?registered=1");
  ASSERT_TRUE(played.open());
  std::vector<int> dotted;
  while (const auto frame = played.next())
    if (frame->image.color_bgr.at<cv::Vec3b>(3, 3)[0] > 200) dotted.push_back(static_cast<int>(frame->image.seq));
  EXPECT_LE(dotted.size(), 4U) << "until it is known";
  EXPECT_TRUE(dotted.empty() || dotted.back() < 8);
  EXPECT_GE(played.counters().of(SkipReason::kEmitterDots), 10U);
  EXPECT_EQ(played.counters().frames_left_out(), 0U);
}

TEST_F(Ros2DeviceTest, colour_without_depth_in_time_is_left_out) {
  begin();
  color(1.1);
  both(1.2);
  color(1.3);
  depth(1.35);
  DeviceSource played = source(std::string(kUri) + "?tolerance_ms=60");
  ASSERT_TRUE(played.open());
  EXPECT_EQ(played.next()->image.stamp_ns, 1'200'000'000);
  EXPECT_EQ(played.next()->image.stamp_ns, 1'300'000'000) << "within 60 ms";
  EXPECT_EQ(played.counters().of(SkipReason::kNoDepthPartner), 1U);
}

TEST_F(Ros2DeviceTest, every_encoding_becomes_bgr_and_depth_of_16_bit) {
  const cv::Mat rgb(24, 32, CV_8UC3, cv::Scalar(1, 2, 3)), grey(24, 32, CV_8UC1, cv::Scalar(9));
  cv::Mat metres(24, 32, CV_32FC1, cv::Scalar(1.5F));
  metres.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  metres.at<float>(0, 1) = std::numeric_limits<float>::infinity();
  info();
  color(1.0, rgb, "rgb8");
  depth(1.0, metres, "32FC1");
  color(1.1, rgb, "rgb8");
  depth(1.1, metres, "32FC1");
  color(1.2, grey, "mono8");
  depth(1.2, metres, "32FC1");
  DeviceSource played = source();
  const SourceFrame first = only_frame(played), second = played.next().value();
  EXPECT_EQ(first.image.color_bgr.at<cv::Vec3b>(5, 5), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(second.image.color_bgr.at<cv::Vec3b>(5, 5), cv::Vec3b(9, 9, 9));
  EXPECT_NEAR(first.image.depth.at<std::uint16_t>(5, 5) * first.image.depth_scale_m, 1.5, 1e-4);
  EXPECT_EQ(first.image.depth.at<std::uint16_t>(0, 0), 0) << "NaN";
  EXPECT_EQ(first.image.depth.at<std::uint16_t>(0, 1), 0) << "infinity";
}

TEST_F(Ros2DeviceTest, rows_may_have_bytes_behind_their_pixels) {
  msg::Image padded = ImageBag::image(ImageBag::depth(), "16UC1", 1.1);
  msg::Image wide = padded;
  wide.step = padded.step + 6;
  wide.data.assign(std::size_t{wide.step} * wide.height, 0xEE);
  for (std::size_t row = 0; row < padded.height; ++row) {
    std::copy_n(padded.data.begin() + static_cast<std::ptrdiff_t>(row * padded.step), padded.step,
                wide.data.begin() + static_cast<std::ptrdiff_t>(row * wide.step));
  }
  begin();
  color(1.1);
  add("/d", "sensor_msgs/Image", wide);
  DeviceSource played = source();
  EXPECT_EQ(only_frame(played).image.depth.at<std::uint16_t>(23, 31), 1500);
}

TEST_F(Ros2DeviceTest, refuses_encodings_sizes_and_byte_orders_by_name) {
  msg::CameraInfo good = ImageBag::camera_info(), large = good;
  large.width = 2560;
  large.height = 1440;
  const msg::Image color = ImageBag::image(ImageBag::color(), "bgr8", 1);
  const msg::Image depth = ImageBag::image(ImageBag::depth(), "16UC1", 1);
  const msg::Image small = ImageBag::image(cv::Mat(12, 16, CV_16UC1, cv::Scalar(1)), "16UC1", 1);
  msg::Image nv42 = color, bytes = depth, big_endian = depth;
  nv42.encoding = "nv42";
  bytes.encoding = "8UC1";
  big_endian.is_bigendian = 1;
  struct Row {
    const msg::CameraInfo& info;
    const msg::Image &color, &depth;
    ::testing::Matcher<std::string> text;
  };
  for (const Row& row :
       {Row{good, nv42, depth, HasSubstr("'nv42'")}, Row{good, color, bytes, HasSubstr("'8UC1'")},
        Row{good, color, big_endian, HasSubstr("big endian")}, Row{good, color, small, HasSubstr("/d has 16 x 12 px")},
        Row{ImageBag::camera_info(0), color, depth,
            AllOf(HasSubstr("/i"), HasSubstr("fx"), HasSubstr("not calibrated"))},
        Row{large, color, depth, HasSubstr("2560 x 1440 px, but a frame carries at most 1920 x 1200")}}) {
    script_.messages.clear();
    info(row.info);
    add("/c", "sensor_msgs/Image", row.color);
    add("/d", "sensor_msgs/Image", row.depth);
    DeviceSource played = source();
    EXPECT_THAT([&] { played.open(); }, ThrowsMessage<SourceError>(row.text));
  }
}

TEST_F(Ros2DeviceTest, reports_what_it_waits_for_and_gives_up) {
  DeviceSource nothing = source();
  EXPECT_THAT([&] { nothing.open(); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("no frame within 30 s"), HasSubstr("colour image on /c"))));
  ASSERT_FALSE(reported_.empty());
  EXPECT_THAT(reported_.front(), HasSubstr("no colour image on /c: state of /c"));

  reported_.clear();
  for (int i = 0; i < 1500; ++i) both(1.0 + 0.033 * i);
  DeviceSource no_info = source();
  EXPECT_THROW(no_info.open(), SourceError);
  EXPECT_THAT(reported_.front(), HasSubstr("no sensor_msgs/CameraInfo on /i: state of /i"));
}

TEST_F(Ros2DeviceTest, reports_stamps_that_do_not_pair) {
  info();
  for (int i = 0; i < 1500; ++i) {
    color(1.0 + 0.033 * i);
    depth(1001.0 + 0.033 * i);
  }
  DeviceSource played = source();
  EXPECT_THROW(played.open(), SourceError);
  ASSERT_FALSE(reported_.empty());
  EXPECT_THAT(reported_.front(),
              AllOf(HasSubstr("no pair"), HasSubstr(" ms apart, allowed are 20"), HasSubstr("tolerance_ms")));
}

TEST_F(Ros2DeviceTest, knows_the_frame_as_the_driver_names_it) {
  info();
  for (const auto& [topic, pixels, encoding] :
       {std::tuple("/c", ImageBag::color(), "bgr8"), std::tuple("/d", ImageBag::depth(), "16UC1")}) {
    msg::Image image = ImageBag::image(pixels, encoding, 1.0);
    image.header.frame_id = "/astra_rgb_optical_frame";
    add(topic, "sensor_msgs/Image", image);
  }
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  EXPECT_EQ(played.info().frame_id, "astra_rgb_optical_frame") << "tf2 has no slash in front";
}

TEST_F(Ros2DeviceTest, reports_a_pause_and_its_end) {
  begin();
  both(1.1);
  DeviceSource played = source();
  only_frame(played);
  EXPECT_EQ(played.next(), std::nullopt) << "the feed closes after a minute";
  ASSERT_FALSE(reported_.empty());
  EXPECT_THAT(reported_.front(), HasSubstr("no colour image on /c"));
}

TEST_F(Ros2DeviceTest, a_clock_that_steps_back_is_an_error_not_silence) {
  info();
  both(100.0);
  both(100.1);
  for (int i = 0; i < 40; ++i) both(1.0 + 0.033 * i);
  DeviceSource played = source();
  only_frame(played);
  EXPECT_THAT([&] { played.next(); }, ThrowsMessage<SourceError>(HasSubstr("went back")));
}

TEST_F(Ros2DeviceTest, broken_messages_and_drops_are_counted) {
  begin();
  both(1.1);
  script_.messages.back().bytes.resize(30);
  both(1.2);
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  script_.dropped = 2;
  EXPECT_EQ(played.next()->image.stamp_ns, 1'200'000'000);
  EXPECT_EQ(played.counters().of(SkipReason::kDepthUnreadable), 1U);
  EXPECT_EQ(played.counters().of(SkipReason::kOverrun), 2U);
}

TEST_F(Ros2DeviceTest, dense_rows_with_a_wrong_step_are_used_and_remarked_once) {
  for (const auto& [topic, step] : {std::pair("/c", 0U), std::pair("/c", 4096U), std::pair("/d", 32U)}) {  // 32: pixels
    script_.messages.clear();
    info();
    for (const double stamp_s : {1.0, 1.1}) {
      msg::Image color = ImageBag::image(ImageBag::color(), "bgr8", stamp_s);
      msg::Image depth = ImageBag::image(ImageBag::depth(), "16UC1", stamp_s);
      (topic == std::string("/c") ? color : depth).step = step;
      add("/c", "sensor_msgs/Image", color);
      add("/d", "sensor_msgs/Image", depth);
    }
    DeviceSource played = source();
    const SourceFrame frame = only_frame(played);
    EXPECT_EQ(frame.image.color_bgr.at<cv::Vec3b>(23, 31), cv::Vec3b(100, 101, 102));
    EXPECT_EQ(frame.image.depth.at<std::uint16_t>(23, 31), 1500);
    EXPECT_THAT(played.info().remarks,
                ElementsAre(AllOf(HasSubstr(topic), HasSubstr("'step' is " + std::to_string(step)))));
  }
}

TEST_F(Ros2DeviceTest, floats_in_millimetres_are_recognised) {
  info();
  for (const double stamp_s : {1.0, 1.1}) {
    color(stamp_s);
    depth(stamp_s, cv::Mat(24, 32, CV_32FC1, cv::Scalar(1500.0)), "32FC1");
  }
  DeviceSource played = source();
  const SourceFrame frame = only_frame(played);
  EXPECT_NEAR(frame.image.depth.at<std::uint16_t>(3, 3) * frame.image.depth_scale_m, 1.5, 1e-3);
}

TEST_F(Ros2DeviceTest, images_without_stamps_go_by_their_arrival) {
  info();
  for (int i = 0; i < 6; ++i) both(0);
  DeviceSource played = source();
  const SourceFrame first = only_frame(played), second = played.next().value();
  EXPECT_THAT(played.info().remarks, ElementsAre(AllOf(HasSubstr("/c are all 0"), HasSubstr("header.stamp"))));
  EXPECT_GT(first.image.stamp_ns, 0);
  EXPECT_EQ(second.image.stamp_ns - first.image.stamp_ns, 2'000'000) << "an image each ms";
}

TEST_F(Ros2DeviceTest, a_simulation_may_begin_at_0) {
  info();
  for (int i = 0; i < 4; ++i) both(0.1 * i);
  DeviceSource played = source();
  EXPECT_EQ(only_frame(played).image.stamp_ns, 200'000'000);
  EXPECT_TRUE(played.info().remarks.empty());
}

TEST_F(Ros2DeviceTest, names_what_makes_every_image_unusable) {
  begin();
  both(1.1);
  for (int i = 0; i < 2000; ++i) {
    color(1.2 + 0.033 * i);
    depth(1.2 + 0.033 * i);
    script_.messages.back().bytes.resize(60);
  }
  DeviceSource played = source();
  only_frame(played);
  EXPECT_EQ(played.next(), std::nullopt);
  ASSERT_FALSE(reported_.empty());
  EXPECT_THAT(reported_.front(), AllOf(HasSubstr("no image can be used"), HasSubstr("/d"), HasSubstr("bytes")));
}

TEST_F(Ros2DeviceTest, what_came_while_it_opened_is_old) {
  script_.clears = true;
  begin();
  both(1.1);
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  EXPECT_TRUE(script_.messages.empty());
}

}  // namespace
}  // namespace rtd::camera
