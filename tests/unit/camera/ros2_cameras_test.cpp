// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
/// Cameras of ROS 2 whose depth has its own lens, that change, or that share their topics.
#include <gmock/gmock.h>

#include "common/camera/live_uri.hpp"
#include "common/camera/open/source_factory.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/ros2_device_fixture.hpp"
#include "tests/unit/camera/two_cameras.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::TwoCameras;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class UnregisteredDepth : public Ros2DeviceTest {
 protected:
  static constexpr const char* kTopics = "ros2:/c,/d,/i?depth_info=/di";
  void pair(double stamp_s) {
    add("/c", "sensor_msgs/Image", cameras_.color_image(stamp_s));
    add("/d", "sensor_msgs/Image", cameras_.depth_image(stamp_s));
  }
  void depth_info() { add("/di", "sensor_msgs/CameraInfo", TwoCameras::info(cameras_.depth)); }
  void transforms(const char* topic) { add(topic, "tf2_msgs/TFMessage", cameras_.transforms()); }
  TwoCameras cameras_;
};

TEST_F(UnregisteredDepth, is_registered_by_both_camera_infos_and_tf_whatever_comes_first) {
  for (const char* topic : {"/tf_static", "/tf"}) {
    script_.messages.clear();
    info(TwoCameras::info(cameras_.color));
    pair(1.0);
    depth_info();
    pair(1.1);
    transforms(topic);
    pair(1.2);
    pair(1.3);
    DeviceSource played = source(kTopics);
    ASSERT_TRUE(played.open()) << topic;
    const SourceFrame frame = played.next().value();
    EXPECT_EQ(frame.image.stamp_ns, 1'300'000'000);
    cameras_.expect_registered(frame.image);
  }
}

TEST_F(UnregisteredDepth, is_refused_with_the_reason) {
  const auto refusal = [&](const auto& put, const auto& words) {
    script_.messages.clear();
    info(TwoCameras::info(cameras_.color));
    for (int i = 0; i < 3; ++i) pair(1.0 + 0.1 * i);
    put();
    DeviceSource played = source(kTopics);
    EXPECT_THAT([&] { played.open(); }, ThrowsMessage<SourceError>(words));
  };
  refusal([] {}, AllOf(HasSubstr("80 x 60"), HasSubstr("CameraInfo of depth on /di (state of /di"),
                       HasSubstr("?registered=1")));
  refusal(
      [&] {
        depth_info();
        pair(1.5);
      },
      AllOf(HasSubstr("from 'camera_depth_optical_frame' to 'camera_color_optical_frame' on /tf_static"),
            HasSubstr("?registered=1")));
  EXPECT_THAT(reported_.back(), HasSubstr("not registered to colour"));
}

TEST_F(UnregisteredDepth, of_one_size_in_another_frame_is_taken_as_it_is_only_on_request) {
  info();
  color(1.0);
  color(1.1);
  msg::Image elsewhere = ImageBag::image(ImageBag::depth(), "16UC1", 1.0);
  elsewhere.header.frame_id = "elsewhere";
  add("/d", "sensor_msgs/Image", elsewhere);
  elsewhere.header.stamp = msg::to_time(1'100'000'000);
  add("/d", "sensor_msgs/Image", elsewhere);
  const auto messages = script_.messages;
  DeviceSource refused = source();
  EXPECT_THAT([&] { refused.open(); }, ThrowsMessage<SourceError>(HasSubstr("'elsewhere'")));
  script_.messages = messages;
  DeviceSource taken = source(std::string(kUri) + "?registered=1");
  EXPECT_EQ(only_frame(taken).image.depth.at<std::uint16_t>(3, 3), 1500);
}

TEST_F(UnregisteredDepth, whose_camera_is_known_late_begins_again) {
  begin();
  both(1.1);
  add("/di", "sensor_msgs/CameraInfo", ImageBag::camera_info(40));
  both(1.2);
  DeviceSource played = source(kTopics);
  only_frame(played);
  EXPECT_EQ(played.next()->image.stamp_ns, 1'200'000'000) << "in one frame: registered by the two lenses";
  EXPECT_THAT(reported_.front(), AllOf(HasSubstr("fx 40"), HasSubstr("again")));
}

TEST_F(UnregisteredDepth, waits_for_a_camera_info_that_is_published) {
  script_.published = {"/di"};
  begin();
  add("/di", "sensor_msgs/CameraInfo", ImageBag::camera_info());
  both(1.1);
  both(1.2);
  DeviceSource played = source(kTopics);
  EXPECT_EQ(only_frame(played).image.stamp_ns, 1'200'000'000);
}

TEST_F(UnregisteredDepth, of_another_size_is_scaled_on_request) {
  info();
  for (const double stamp_s : {1.0, 1.1}) {
    color(stamp_s);
    depth(stamp_s, cv::Mat(12, 16, CV_16UC1, cv::Scalar(1200)));
  }
  DeviceSource played = source(std::string(kUri) + "?registered=1");
  const SourceFrame frame = only_frame(played);
  EXPECT_EQ(frame.image.depth.size(), cv::Size(32, 24));
  EXPECT_EQ(frame.image.depth.at<std::uint16_t>(23, 31), 1200);
}

TEST_F(UnregisteredDepth, of_another_shape_gets_no_advice_that_cannot_help) {
  info();
  for (int i = 0; i < 20; ++i) {
    color(1.0 + 0.1 * i);
    depth(1.0 + 0.1 * i, cv::Mat(24, 24, CV_16UC1, cv::Scalar(1200)));
  }
  DeviceSource played = source();
  EXPECT_THAT([&] { played.open(); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("24 x 24"), ::testing::Not(HasSubstr("registered=1")))));
}

class ChangedCamera : public Ros2DeviceTest {
 protected:
  static constexpr int kWidth = 16, kHeight = 12;
  static msg::CameraInfo small_info() {
    msg::CameraInfo info = ImageBag::camera_info(15);
    info.width = kWidth;
    info.height = kHeight;
    return info;
  }
  void small(double stamp_s) {
    color(stamp_s, cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(7, 8, 9)));
    depth(stamp_s, cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(900)));
  }
};

TEST_F(ChangedCamera, begins_again_with_the_new_size_and_calibration) {
  begin();
  both(1.1);
  info(small_info());
  for (int i = 0; i < 40; ++i) small(1.2 + 0.033 * i);
  DeviceSource played = source();
  EXPECT_EQ(only_frame(played).image.color_bgr.cols, 32);
  const SourceFrame frame = played.next().value();
  EXPECT_EQ(frame.image.color_bgr.cols, kWidth);
  EXPECT_EQ(frame.image.camera.parameters().fx, 15);
  EXPECT_EQ(frame.image.seq, 1U);
  ASSERT_FALSE(reported_.empty());
  EXPECT_THAT(reported_.front(), AllOf(HasSubstr("16 x 12"), HasSubstr("32 x 24"), HasSubstr("again")));
  EXPECT_EQ(played.counters().reconnects, 1U);
}

TEST_F(ChangedCamera, of_the_same_size_with_another_lens_begins_again) {
  begin();
  both(1.1);
  info(ImageBag::camera_info(40));
  for (int i = 0; i < 40; ++i) both(1.2 + 0.033 * i);
  DeviceSource played = source();
  std::optional<SourceFrame> last;
  EXPECT_TRUE(played.open());
  while (std::optional<SourceFrame> frame = played.next()) last = std::move(frame);
  EXPECT_EQ(last->image.camera.parameters().fx, 40);
  EXPECT_THAT(reported_.front(), AllOf(HasSubstr("/i has changed"), HasSubstr("fx 40"), HasSubstr("fx 30")));
}

TEST_F(ChangedCamera, that_alternates_keeps_the_frames_of_the_first_size) {
  for (int i = 0; i < 40; ++i) {
    info();
    both(1.0 + 0.2 * i);
    info(small_info());
    small(1.1 + 0.2 * i);
  }
  DeviceSource played = source();
  EXPECT_TRUE(played.open());
  int frames = 0;
  while (const std::optional<SourceFrame> frame = played.next()) frames += frame->image.color_bgr.cols == 32 ? 1 : 1000;
  EXPECT_EQ(frames, 39);
  EXPECT_EQ(played.counters().of(SkipReason::kSizeMismatch), 40U);
}

TEST_F(ChangedCamera, whose_info_never_fits_is_refused_with_both_sizes) {
  info(small_info());
  for (int i = 0; i < 1200; ++i) both(1.0 + 0.033 * i);
  DeviceSource played = source();
  EXPECT_THAT([&] { played.open(); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("colour 32 x 24"), HasSubstr("calibration 16 x 12"))));
}

class SecondCamera : public Ros2DeviceTest {
 protected:
  void both_of(const char* frame, double stamp_s) {
    for (const char* topic : {"/c", "/d"}) {
      const bool color = std::string(topic) == "/c";
      msg::Image image =
          ImageBag::image(color ? ImageBag::color() : ImageBag::depth(), color ? "bgr8" : "16UC1", stamp_s);
      image.header.frame_id = frame;
      add(topic, "sensor_msgs/Image", image);
    }
  }
};

TEST_F(SecondCamera, on_the_same_topics_is_left_out_and_counted) {
  info();
  both_of("front", 1.0);
  for (int i = 0; i < 40; ++i) {
    both_of("front", 1.1 + 0.1 * i);
    both_of("rear", 1.15 + 0.1 * i);
  }
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  std::size_t frames = 0;
  while (const auto frame = played.next()) {
    ++frames;
    EXPECT_EQ((frame->image.stamp_ns + 1'000'000) / 10'000'000 % 10, 0) << "not of the rear camera";
  }
  EXPECT_EQ(frames, 40U);
  EXPECT_EQ(played.counters().of(SkipReason::kOtherCamera), 40U);
  EXPECT_THAT(played.take_skipped().front().detail, AllOf(HasSubstr("'front'"), HasSubstr("'rear'")));
}

TEST_F(SecondCamera, in_place_of_the_first_is_followed) {
  info();
  both_of("front", 1.0);
  both_of("front", 1.1);
  for (int i = 0; i < 40; ++i) both_of("driver_2", 1.2 + 0.1 * i);
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  while (played.next()) continue;
  EXPECT_GT(played.counters().frames, 8U);
  EXPECT_THAT(reported_, testing::Contains(HasSubstr("in frame 'driver_2' now: the camera begins again")));
}

TEST(LiveOptionsTest, name_their_topics) {
  const LiveOptions options = parse_live_options("ros2:/cam/color/image_raw/compressed,cam/depth?tolerance_ms=5");
  EXPECT_EQ(options.topics.color, "/cam/color/image_raw/compressed");
  EXPECT_EQ(options.topics.depth, "/cam/depth");
  EXPECT_EQ(options.topics.info, "/cam/color/camera_info");
  EXPECT_EQ(options.tolerance_ns, 5'000'000);
  EXPECT_EQ(parse_live_options("ros2:/a/x,/b,/c").topics.info, "/c");
  EXPECT_EQ(parse_live_options("ros2:/a/x,/b/depth/compressedDepth").topics.depth_info, "/b/camera_info");
  EXPECT_EQ(parse_live_options("ros2:/a/x,/b/y?depth_info=e").topics.depth_info, "/e");
  EXPECT_TRUE(parse_live_options("ros2:/a,/b?registered=1").registered);
  for (const char* uri : {"ros2:", "ros2:/a", "ros2:/a,/b,/c,/d", "ros2:/a,,/c", "ros2:/a,/a"}) {
    EXPECT_THAT([&] { parse_live_options(uri); }, ThrowsMessage<SourceError>(HasSubstr("ros2:COLOR_TOPIC,DEPTH_TOPIC")))
        << uri;
  }
  EXPECT_THAT([] { parse_live_options("ros2:/a,/b?tolerance_ms=x"); }, ThrowsMessage<SourceError>(HasSubstr("'x'")));
  EXPECT_THAT([] { parse_live_options("ros2:/a,/b?fps=3"); }, ThrowsMessage<SourceError>(HasSubstr("'fps'")));
  EXPECT_TRUE(test::refuses("ros2:/a,/b", {"running camera"}));
}

}  // namespace
}  // namespace rtd::camera
