// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/ros2/ros2_device.hpp"

#include <gmock/gmock.h>

#include <deque>
#include <limits>
#include <set>
#include <tuple>

#include "services/camera/core/live/device_source.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/played_device.hpp"
#include "tests/unit/camera/two_cameras.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::TwoCameras;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kUri = "ros2:/c,/d,/i";

/// A camera that a test plays. An empty feed lets its clock continue, and closes it after a minute.
struct FeedScript {
  std::deque<RecordedMessage> messages;
  std::uint64_t dropped = 0;
  std::set<std::string> published;
  bool clears = false;  ///< as the real one; a test of one stream leaves it off
  test::PlayedTime time{.now_ns = 0};
};

class PlayedFeed : public LiveFeed {
 public:
  explicit PlayedFeed(FeedScript& script) : script_(script) {}

  std::optional<RecordedMessage> next(std::chrono::milliseconds timeout) override {
    test::PlayedTime& time = script_.time;
    if (script_.messages.empty()) {
      time.go_on(std::chrono::nanoseconds(timeout).count());
      time.closed = time.closed || time.now_ns > 60'000'000'000;
      return std::nullopt;
    }
    RecordedMessage message = std::move(script_.messages.front());
    script_.messages.pop_front();
    time.go_on(1'000'000);
    message.recorded_ns = time.now_ns;
    return message;
  }
  void clear() override {
    if (script_.clears) script_.messages.clear();
  }
  std::uint64_t dropped() const override { return script_.dropped; }
  std::int64_t now_ns() const override { return script_.time.now_ns; }
  std::string state_of(const std::string& topic) const override { return "state of " + topic; }
  bool is_published(const std::string& topic) const override { return script_.published.contains(topic); }

 private:
  FeedScript& script_;
};

class Ros2DeviceTest : public ::testing::Test {
 protected:
  template <class Message>
  void add(const std::string& topic, const std::string& type, const Message& message) {
    RecordedMessage live;
    live.type = type;
    live.topic = topic;
    live.wire = ros::Wire::kCdr;
    live.bytes = ros::encode<ros::Wire::kCdr>(message);
    script_.messages.push_back(std::move(live));
  }
  void info(const msg::CameraInfo& info = ImageBag::camera_info()) { add("/i", "sensor_msgs/CameraInfo", info); }
  void color(double stamp_s, const cv::Mat& pixels = ImageBag::color(), const std::string& encoding = "bgr8") {
    add("/c", "sensor_msgs/Image", ImageBag::image(pixels, encoding, stamp_s));
  }
  void depth(double stamp_s, const cv::Mat& pixels = ImageBag::depth(), const std::string& encoding = "16UC1") {
    add("/d", "sensor_msgs/Image", ImageBag::image(pixels, encoding, stamp_s));
  }
  void both(double stamp_s) {
    color(stamp_s);
    depth(stamp_s);
  }
  /// What open() waits for.
  void begin() {
    info();
    both(1.0);
  }
  DeviceSource source(const std::string& uri = kUri) {
    script_.time = {.now_ns = 0};
    const LiveOptions ros2 = parse_live_options(uri);
    DeviceOptions options;
    options.uri.text = uri;
    options.uri.calibration_file = ros2.calibration_file;
    options.uri.tolerance_ns = ros2.tolerance_ns;
    options.on_wait = [this](const std::string& what) { reported_.push_back(what); };
    return {std::make_unique<Ros2Device>(uri, std::make_unique<PlayedFeed>(script_), ros2),
            std::make_unique<test::PlayedClock>(script_.time), options};
  }
  /// The frame made of one pair of images.
  static SourceFrame only_frame(DeviceSource& source) {
    EXPECT_TRUE(source.open());
    return source.next().value();
  }

  FeedScript script_;
  std::vector<std::string> reported_;
};

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
  const auto refusal = [&](const auto& put, const char* text) {
    script_.messages.clear();
    put();
    DeviceSource played = source();
    EXPECT_THAT([&] { played.open(); }, ThrowsMessage<SourceError>(HasSubstr(text)));
  };
  refusal(
      [&] {
        info();
        color(1, ImageBag::color(), "nv42");
        depth(1);
      },
      "'nv42'");
  refusal(
      [&] {
        info();
        color(1);
        depth(1, ImageBag::depth(), "8UC1");
      },
      "'8UC1'");
  refusal(
      [&] {
        info();
        color(1);
        depth(1, cv::Mat(12, 16, CV_16UC1, cv::Scalar(1)));
      },
      "/d has 16 x 12 px");
  refusal([&] { info(ImageBag::camera_info(0)); }, "not calibrated");
  refusal(
      [&] {
        msg::CameraInfo large = ImageBag::camera_info();
        large.width = 2560;
        large.height = 1440;
        info(large);
      },
      "2560 x 1440 px, but a frame carries at most 1920 x 1200");
  refusal(
      [&] {
        msg::Image big_endian = ImageBag::image(ImageBag::depth(), "16UC1", 1);
        big_endian.is_bigendian = 1;
        info();
        color(1);
        add("/d", "sensor_msgs/Image", big_endian);
      },
      "big endian");
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

TEST_F(Ros2DeviceTest, dense_rows_with_a_wrong_step_are_used_and_remarked_once) {
  info();
  for (const double stamp_s : {1.0, 1.1}) {
    msg::Image color = ImageBag::image(ImageBag::color(), "bgr8", stamp_s);
    color.step = 0;
    add("/c", "sensor_msgs/Image", color);
    depth(stamp_s);
  }
  DeviceSource played = source();
  EXPECT_EQ(only_frame(played).image.color_bgr.at<cv::Vec3b>(5, 5), cv::Vec3b(100, 101, 102));
  EXPECT_THAT(played.info().remarks, ElementsAre(AllOf(HasSubstr("/c"), HasSubstr("'step' is 0"))));
}

TEST_F(Ros2DeviceTest, dense_depth_whose_step_counts_pixels_is_used) {
  info();
  for (const double stamp_s : {1.0, 1.1}) {
    color(stamp_s);
    msg::Image depth = ImageBag::image(ImageBag::depth(), "16UC1", stamp_s);
    depth.step = ImageBag::kWidth;  // not bytes
    add("/d", "sensor_msgs/Image", depth);
  }
  DeviceSource played = source();
  EXPECT_EQ(only_frame(played).image.depth.at<std::uint16_t>(23, 31), 1500);
  EXPECT_THAT(played.info().remarks, ElementsAre(AllOf(HasSubstr("/d"), HasSubstr("'step' is 32"))));
}

TEST_F(Ros2DeviceTest, dense_rows_whose_step_is_too_long_are_used) {
  info();
  for (const double stamp_s : {1.0, 1.1}) {
    msg::Image color = ImageBag::image(ImageBag::color(), "bgr8", stamp_s);
    color.step = 4096;
    add("/c", "sensor_msgs/Image", color);
    depth(stamp_s);
  }
  DeviceSource played = source();
  EXPECT_EQ(only_frame(played).image.color_bgr.at<cv::Vec3b>(23, 31), cv::Vec3b(100, 101, 102));
  EXPECT_THAT(played.info().remarks, ElementsAre(HasSubstr("'step' is 4096")));
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

TEST_F(Ros2DeviceTest, a_camera_info_of_zeros_is_refused_by_its_value) {
  info(ImageBag::camera_info(0));  // a driver without a calibration file
  for (int i = 0; i < 20; ++i) both(1.0 + 0.1 * i);
  DeviceSource played = source();
  EXPECT_THAT([&] { played.open(); }, ThrowsMessage<SourceError>(AllOf(HasSubstr("/i"), HasSubstr("fx"))));
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

TEST_F(Ros2DeviceTest, what_came_while_it_opened_is_old) {
  script_.clears = true;
  begin();
  both(1.1);
  DeviceSource played = source();
  ASSERT_TRUE(played.open());
  EXPECT_TRUE(script_.messages.empty());
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

}  // namespace
}  // namespace rtd::camera
