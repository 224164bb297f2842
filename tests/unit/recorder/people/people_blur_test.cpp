// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/people/people_blur.hpp"

#include <gmock/gmock.h>

#include <set>

#include "common/vision/detection.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/recorder/people/blur_line.hpp"
#include "tests/support/people_messages.hpp"

namespace rtd::recorder {
namespace {

using namespace test_support;
using Bytes = std::vector<std::uint8_t>;

const BlurTopic kFrame{"rtd/frame", "rtd_msgs/RgbdFrame"},
    kDetections{"rt/detector/detections", "vision_msgs/Detection2DArray"},
    kMasks{"rt/detector/masks", "sensor_msgs/Image"},
    kJpeg{"rt/camera/color/image_raw/compressed", "sensor_msgs/CompressedImage"},
    kDriver{"rt/driver/color/image_raw", "sensor_msgs/Image"};
constexpr std::int64_t kStampNs = 5'000'000'000, kFrameNs = 33'000'000;
constexpr const char* kCameraFrame = "camera_color_optical_frame";

/// Labels of the detector: the left 40 px of the lower half belong to a person.
msg::Image masks(std::int64_t stamp_ns) {
  msg::Image message;
  message.header = {msg::to_time(stamp_ns), kCameraFrame};
  message.width = message.step = 80;
  message.height = 60;
  message.encoding = "mono8";
  message.data.assign(std::size_t{80} * 60, 0);
  for (std::size_t row = 30; row < 60; ++row) std::fill_n(message.data.begin() + 80 * row, 10, 1);
  return message;
}

msg::Image driver_image(const cv::Mat& pixels, const std::string& encoding = "bgr8",
                        const std::string& frame = kCameraFrame) {
  msg::Image message;
  message.header = {msg::to_time(kStampNs), frame};
  message.height = static_cast<std::uint32_t>(pixels.rows);
  message.width = static_cast<std::uint32_t>(pixels.cols);
  message.encoding = encoding;
  message.step = message.width * static_cast<std::uint32_t>(pixels.elemSize());
  message.data.assign(pixels.datastart, pixels.dataend);
  return message;
}

/// Colours that are left of a part of an image.
std::size_t colors_in(const cv::Mat& part) {
  std::set<std::array<std::uint8_t, 3>> colors;
  for (const cv::Vec3b& color : cv::Mat_<cv::Vec3b>(part)) colors.insert({color[0], color[1], color[2]});
  return colors.size();
}

class PeopleBlurTest : public ::testing::Test {
 protected:
  void detect(const std::vector<cv::Rect>& people, std::int64_t stamp_ns = kStampNs) {
    blur_.learn(kDetections, cdr_of(detections(stamp_ns, people)));
  }
  PeopleBlur::Result apply(const BlurTopic& topic, const Bytes& cdr) {
    blur_.learn(topic, cdr);
    return blur_.apply(topic, cdr);
  }
  PeopleBlur::Result apply_frame(std::int64_t stamp_ns = kStampNs) { return apply(kFrame, frame_cdr(stamp_ns, room_)); }

  const cv::Mat room_ = room_with_person();
  PeopleBlur blur_;
};

TEST_F(PeopleBlurTest, makes_people_in_frames_unrecognisable_and_leaves_the_rest) {
  detect({kPerson});
  const PeopleBlur::Result result = apply_frame();
  ASSERT_EQ(result.fate, Fate::kBlurred);
  const cv::Mat blurred = colors_of(result.cdr);
  EXPECT_GT(likeness(room_, room_), 0.99);
  EXPECT_LT(likeness(room_, blurred), 0.5);
  EXPECT_LE(colors_in(blurred(kFace)), 9U) << "squares of a quarter of the person's width";
  const cv::Rect grown = cv::Rect(kPerson.x - 12, kPerson.y - 27, kPerson.width + 24, kPerson.height + 27);
  EXPECT_LT(colors_in(blurred(grown)), 100U) << "hands and hair too";
  const cv::Rect left(0, 0, 80, 240), right(200, 0, 120, 240);
  for (const cv::Rect& side : {left, right}) EXPECT_EQ(cv::norm(blurred(side), room_(side), cv::NORM_INF), 0);
  Bytes original = frame_cdr(kStampNs, room_);
  const auto pixels = static_cast<std::ptrdiff_t>(4 + offsetof(msg::RgbdFrame, color_bgr));
  const auto behind = pixels + static_cast<std::ptrdiff_t>(room_.total() * 3);
  EXPECT_TRUE(std::equal(original.begin(), original.begin() + pixels, result.cdr.begin()));
  EXPECT_TRUE(std::equal(original.begin() + behind, original.end(), result.cdr.begin() + behind)) << "depth";
}

TEST_F(PeopleBlurTest, a_face_that_fills_the_image_is_unrecognisable_too) {
  cv::Mat close(room_.size(), room_.type());
  cv::resize(room_(kFace), close, close.size());
  detect({{0, 0, 320, 240}});
  const cv::Mat blurred = colors_of(apply(kFrame, frame_cdr(kStampNs, close)).cdr);
  EXPECT_LE(colors_in(blurred), 40U);
}

TEST_F(PeopleBlurTest, masks_count_where_they_are_larger_than_boxes) {
  detect({kPerson});
  blur_.learn(kMasks, cdr_of(masks(kStampNs)));
  const cv::Mat blurred = colors_of(apply_frame().cdr);
  EXPECT_LT(colors_in(blurred(cv::Rect(0, 120, 40, 120))), 40U);
  const cv::Rect above(0, 0, 40, 110);
  EXPECT_EQ(cv::norm(blurred(above), room_(above), cv::NORM_INF), 0);
}

TEST_F(PeopleBlurTest, images_without_people_stay_byte_by_byte) {
  detect({});
  blur_.learn(kDetections, cdr_of(detections(kStampNs, {kPerson}, "chair")));
  EXPECT_EQ(apply_frame().fate, Fate::kKept);
}

TEST_F(PeopleBlurTest, an_image_that_nothing_is_known_about_is_hidden_as_a_whole) {
  for (const bool too_far : {false, true}) {
    if (too_far) detect({}, kStampNs - 8 * kFrameNs);
    const PeopleBlur::Result result = apply_frame();
    ASSERT_EQ(result.fate, Fate::kHidden);
    EXPECT_LE(colors_in(colors_of(result.cdr)), 36U);
  }
  detect({}, kStampNs - kFrameNs);
  EXPECT_EQ(apply_frame().fate, Fate::kHidden) << "someone may have come since";
  EXPECT_EQ(blur_.counts().at("hidden"), 3U);
}

TEST_F(PeopleBlurTest, detections_just_before_and_after_an_image_count_for_it) {
  detect({kPerson}, kStampNs - 2 * kFrameNs);
  detect({}, kStampNs + kFrameNs);
  PeopleBlur::Result result = apply_frame();
  ASSERT_EQ(result.fate, Fate::kBlurred);
  EXPECT_LT(likeness(room_, colors_of(result.cdr)), 0.5);
  detect({}, kStampNs);
  result = apply_frame();
  EXPECT_EQ(result.fate, Fate::kBlurred) << "missed once";
}

TEST_F(PeopleBlurTest, other_images_of_the_detectors_camera_are_blurred_where_people_are) {
  detect({kPerson});
  apply_frame();
  const auto decoded = [](const Bytes& cdr) {
    return vision::decode_image(ros::decode<msg::CompressedImage>(ros::Wire::kCdr, cdr).data).pixels;
  };
  msg::CompressedImage jpeg;
  jpeg.header.stamp = msg::to_time(kStampNs);
  jpeg.data = vision::encode_jpeg(room_);
  const PeopleBlur::Result compressed = apply(kJpeg, cdr_of(jpeg));
  ASSERT_EQ(compressed.fate, Fate::kBlurred);
  EXPECT_LT(likeness(room_, decoded(compressed.cdr)), 0.5);
  cv::Mat rgb, yuv;
  cv::cvtColor(room_, rgb, cv::COLOR_BGR2RGB);
  for (const auto& [pixels, encoding] : {std::pair(rgb, "rgb8"), std::pair(room_, "bgr8")}) {
    const PeopleBlur::Result raw = apply(kDriver, cdr_of(driver_image(pixels, encoding)));
    ASSERT_EQ(raw.fate, Fate::kBlurred);
    const auto image = ros::decode<msg::Image>(ros::Wire::kCdr, raw.cdr);
    EXPECT_EQ(image.encoding, "bgr8");
    EXPECT_EQ(image.header.frame_id, kCameraFrame);
    const cv::Mat blurred(240, 320, CV_8UC3, const_cast<std::uint8_t*>(image.data.data()));
    EXPECT_LT(likeness(room_, blurred), 0.5);
    EXPECT_EQ(cv::norm(blurred.colRange(0, 80), room_.colRange(0, 80), cv::NORM_INF), 0);
  }
}

TEST_F(PeopleBlurTest, images_of_other_cameras_and_sizes_are_hidden) {
  detect({});
  apply_frame();
  EXPECT_EQ(apply(kDriver, cdr_of(driver_image(room_))).fate, Fate::kKept);
  EXPECT_EQ(apply(kDriver, cdr_of(driver_image(room_, "bgr8", "rear_optical_frame"))).fate, Fate::kHidden);
  EXPECT_EQ(apply(kDriver, cdr_of(driver_image(room_(cv::Rect(0, 0, 160, 120)).clone()))).fate, Fate::kHidden);
  const cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(90)), grey16(240, 320, CV_16UC1, cv::Scalar(900));
  EXPECT_EQ(
      apply({"rt/cam/infra1/image_rect_raw", "sensor_msgs/Image"}, cdr_of(driver_image(grey, "mono8", "ir"))).fate,
      Fate::kHidden);
  EXPECT_EQ(apply({"rt/kinect/ir/image_raw", "sensor_msgs/Image"}, cdr_of(driver_image(grey16, "16UC1", "ir"))).fate,
            Fate::kHidden);
}

TEST_F(PeopleBlurTest, depth_and_masks_stay_and_what_cannot_be_pixelated_is_withheld) {
  const cv::Mat grey16(240, 320, CV_16UC1, cv::Scalar(900));
  const auto fate = [&](const std::string& topic, const std::string& type, const Bytes& cdr) {
    return apply({topic, type}, cdr).fate;
  };
  EXPECT_EQ(fate("rt/cam/depth/image_raw", "sensor_msgs/Image", cdr_of(driver_image(grey16, "16UC1"))), Fate::kKept);
  EXPECT_EQ(fate(kMasks.name, kMasks.type, cdr_of(masks(kStampNs))), Fate::kKept);
  EXPECT_EQ(fate("rt/cam/color/ffmpeg", "ffmpeg_image_transport_msgs/FFMPEGPacket", Bytes(40)), Fate::kWithheld);
  EXPECT_EQ(fate("rt/cam/color/video", "foxglove_msgs/CompressedVideo", Bytes(40)), Fate::kWithheld);
  EXPECT_EQ(fate(kDriver.name, kDriver.type, Bytes(12)), Fate::kWithheld) << "damaged";
  EXPECT_EQ(fate(kDriver.name, kDriver.type, cdr_of(driver_image(grey16, "strange"))), Fate::kWithheld);
  msg::CompressedImage broken;
  broken.data = {0xff, 0xd8, 0xff};
  EXPECT_EQ(fate(kJpeg.name, kJpeg.type, cdr_of(broken)), Fate::kWithheld);
  msg::PointCloud2 cloud;
  cloud.point_step = 16;
  cloud.fields = {{"x", 0, 7, 1}};
  EXPECT_EQ(fate("rt/cam/points", "sensor_msgs/PointCloud2", cdr_of(cloud)), Fate::kKept);
  cloud.fields.push_back({"rgb", 4, 7, 1});
  EXPECT_EQ(fate("rt/cam/points", "sensor_msgs/PointCloud2", cdr_of(cloud)), Fate::kWithheld);
  EXPECT_EQ(fate("rt/slam/pose", "geometry_msgs/PoseStamped", Bytes(40)), Fate::kKept);
}

TEST_F(PeopleBlurTest, detections_count_for_their_own_robot) {
  blur_.learn({"rt/anna/detector/detections", kDetections.type}, cdr_of(detections(kStampNs, {})));
  EXPECT_EQ(apply({"rtd/anna/frame", kFrame.type}, frame_cdr(kStampNs, room_)).fate, Fate::kKept);
  EXPECT_EQ(apply_frame().fate, Fate::kHidden);
}

class BlurLineTest : public ::testing::Test {
 protected:
  void push(const BlurTopic& topic, const Bytes& cdr, std::int64_t now_ns = 0) {
    const std::string type = topic.type == kFrame.type        ? "rtd_msgs::msg::dds_::RgbdFrame_"
                             : topic.type == kDetections.type ? "vision_msgs::msg::dds_::Detection2DArray_"
                                                              : "geometry_msgs::msg::dds_::PoseStamped_";
    auto bytes = std::make_shared<bus::ByteBlock>();
    bytes->assign(std::as_bytes(std::span(cdr)));
    line_.push({book_.find_or_add(topic.name, type), ++sequence_, 0, 0, std::move(bytes)}, now_ns);
  }
  /// The numbers of the messages that come out now.
  std::vector<std::uint32_t> pop(std::int64_t now_ns = 0, bool ended = false) {
    std::vector<std::uint32_t> numbers;
    while (const auto message = line_.pop(now_ns, ended)) numbers.push_back(message->sequence);
    return numbers;
  }
  const cv::Mat room_ = room_with_person();
  const BlurTopic pose_{"rt/slam/pose", "geometry_msgs/PoseStamped"};
  TopicRegistry book_;
  BlurLine line_{book_};
  std::uint32_t sequence_ = 0;
};

TEST_F(BlurLineTest, keeps_the_order_while_an_image_waits_for_its_detections) {
  using ::testing::ElementsAre;
  using ::testing::IsEmpty;
  push(pose_, Bytes(40));
  push(kFrame, frame_cdr(kStampNs, room_));
  push(pose_, Bytes(40));
  EXPECT_THAT(pop(), ElementsAre(1));
  push(kDetections, cdr_of(detections(kStampNs, {kPerson})));
  EXPECT_THAT(pop(), IsEmpty()) << "the next batch may see who is missed";
  push(kDetections, cdr_of(detections(kStampNs + 8 * kFrameNs, {})));
  EXPECT_THAT(pop(), ElementsAre(2, 3, 4, 5));
  EXPECT_EQ(line_.people().counts().at("blurred"), 1U);
}

TEST_F(BlurLineTest, waits_ten_seconds_at_most_and_not_at_the_end) {
  using ::testing::ElementsAre;
  using ::testing::IsEmpty;
  push(kFrame, frame_cdr(kStampNs, room_));
  push(kFrame, frame_cdr(kStampNs + kFrameNs, room_), 1'000'000'000);
  EXPECT_THAT(pop(9'900'000'000), IsEmpty());
  EXPECT_THAT(pop(10'100'000'000), ElementsAre(1));
  EXPECT_THAT(pop(10'100'000'000, true), ElementsAre(2));
  EXPECT_EQ(line_.people().counts().at("hidden"), 2U);
}

TEST_F(BlurLineTest, holds_a_bounded_number_of_bytes) {
  const Bytes frame = frame_cdr(kStampNs, room_);
  for (std::size_t i = 0; i < 128 * 1024 * 1024 / frame.size() + 10; ++i) push(kFrame, frame);
  EXPECT_EQ(pop().size(), 10U);
}

}  // namespace
}  // namespace rtd::recorder
