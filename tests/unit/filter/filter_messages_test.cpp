// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/filter_messages.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "common/msg/transform_eigen.hpp"
#include "common/vision/rgbd_image.hpp"

namespace rtd::filter {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using vision::defect;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

msg::Detection2D box(double centre_px, double size_px, double score) {
  msg::Detection2D detection;
  detection.bbox.center.position = {centre_px, centre_px};
  detection.bbox.size_x = detection.bbox.size_y = size_px;
  detection.results.push_back({{"cup", 0.1}, {}});
  detection.results.push_back({{"person", score}, {}});
  return detection;
}
msg::Detection2D named_box(const char* name, double score, double x, double y, double width, double height) {
  msg::Detection2D detection;
  msg::ObjectHypothesisWithPose result;
  result.hypothesis = {name, score};
  detection.results = {result};
  detection.bbox = {{{x, y}, 0}, width, height};
  return detection;
}

TEST(DetectionMessage, takes_the_best_hypothesis_and_the_corner_of_the_box) {
  msg::Detection2DArray message;
  message.header.stamp = {1, 5};
  message.detections = {box(50, 20, 0.8)};
  const DetectionBatch converted = to_detection_batch(message);
  EXPECT_EQ(converted.stamp_ns, 1'000'000'005);
  ASSERT_EQ(converted.detections.size(), 1U);
  EXPECT_EQ(converted.detections[0].class_name, "person");
  EXPECT_FLOAT_EQ(converted.detections[0].x_px, 40.0F);
}

msg::Image labels(std::uint32_t width, std::uint32_t height) {
  msg::Image message{.height = height, .width = width, .encoding = "mono8", .step = width};
  message.data.assign(std::size_t{width} * height, 0);
  return message;
}

TEST(MasksMessage, becomes_labels) {
  msg::Image message = labels(160, 120);
  message.data[161] = 2;
  const vision::PersonMasks masks = to_person_masks(message).masks;
  EXPECT_EQ(masks.columns, 160);
  EXPECT_EQ(masks.rows, 120);
  EXPECT_EQ(masks.at(1, 1), 2);
}

TEST(MasksMessage, of_another_encoding_step_or_size_is_refused_with_its_numbers) {
  const auto expect_refused = [](const msg::Image& message, const char* text) {
    EXPECT_THAT(to_person_masks(message).problem, HasSubstr(text));
    EXPECT_TRUE(to_person_masks(message).masks.empty());
  };
  msg::Image wide = labels(8, 4), short_of = labels(8, 4), coloured = labels(8, 4);
  wide.step = 12;
  short_of.data.pop_back();
  coloured.encoding = "bgr8";
  expect_refused(wide, "step 12");
  expect_refused(short_of, "31 bytes");
  expect_refused(coloured, "'bgr8'");
}

TEST(MasksMessage, must_fit_the_frame_and_its_boxes) {
  msg::FrameView frame{};
  frame.width = 637;
  frame.height = 480;
  const auto problem_of = [&](std::uint32_t columns, std::uint32_t rows, std::uint8_t label) {
    std::vector<DetectionBatch> batches = {
        {1, {{"person", 0.9F, 0, 0, 9, 9}}, to_person_masks(labels(columns, rows)).masks}};
    batches[0].masks.labels[0] = label;
    const std::string problem = drop_misfits(batches, frame);
    EXPECT_EQ(batches[0].masks.empty(), !problem.empty());
    return problem;
  };
  EXPECT_EQ(problem_of(160, 120, 1), "");
  EXPECT_EQ(problem_of(160, 120, 2), "label 2 of 1 detections");
  EXPECT_EQ(problem_of(80, 60, 1), "80x60 labels where the frame has 160x120");
  std::vector<DetectionBatch> without(1);
  EXPECT_EQ(drop_misfits(without, frame), "");
}

TEST(DetectionMessage, leaves_out_invalid_boxes) {
  msg::Detection2DArray message;
  message.detections = {box(std::nan(""), 20, 0.8), box(50, 0, 0.8), box(50, -3, 0.8),
                        box(50, std::numeric_limits<double>::infinity(), 0.8), msg::Detection2D{}};
  EXPECT_THAT(to_detection_batch(message).detections, IsEmpty());
}

TEST(DetectionMessage, of_ten_thousand_boxes_the_best_are_kept) {
  msg::Detection2DArray message;
  for (int i = 0; i < 10'000; ++i) message.detections.push_back(box(50, 20, 0.2 + 0.00005 * i));
  const auto kept = to_detection_batch(message).detections;
  EXPECT_EQ(kept.size(), 300U);
  EXPECT_GT(kept.back().score, 0.68F);
}

TEST(DetectionMessage, becomes_boxes_with_their_corner) {
  msg::Detection2DArray message;
  message.header.stamp = msg::to_time(1'234'567'890);
  message.detections = {named_box("person", 0.8, 100, 200, 40, 60)};
  const DetectionBatch boxes = to_detection_batch(message);
  EXPECT_EQ(boxes.stamp_ns, 1'234'567'890);
  ASSERT_EQ(boxes.detections.size(), 1U);
  EXPECT_FLOAT_EQ(boxes.detections[0].x_px, 80);
  EXPECT_FLOAT_EQ(boxes.detections[0].y_px, 170);
}

TEST(DetectionMessage, drops_boxes_that_make_no_sense) {
  msg::Detection2DArray message;
  message.detections = {named_box("person", kNan, 1, 1, 1, 1),   named_box("person", 0.5, kInf, 1, 1, 1),
                        named_box("person", 0.5, 1, 1, kNan, 1), named_box("person", 0.5, 1, 1, -4, 1),
                        named_box("person", 0.5, 1, 1, 0, 0),    msg::Detection2D{}};
  EXPECT_TRUE(to_detection_batch(message).detections.empty());
  message.detections.assign(10'000, named_box("person", 0.5, 100, 100, 10, 10));
  message.detections[9'999].results[0].hypothesis.score = 0.9;
  const DetectionBatch boxes = to_detection_batch(message);
  EXPECT_LE(boxes.detections.size(), 1000U);
  EXPECT_FLOAT_EQ(boxes.detections[0].score, 0.9F) << "the best are kept";
}

std::unique_ptr<msg::RgbdFrame> good_frame() {
  auto frame = std::make_unique<msg::RgbdFrame>();
  *frame = {};
  frame->seq = 9;
  frame->width = 320;
  frame->height = 240;
  frame->intrinsics = {260, 260, 160, 120};
  frame->depth_scale_m = 0.0002;
  return frame;
}

TEST(FrameMessages, names_what_is_wrong_with_a_frame) {
  auto frame = good_frame();
  EXPECT_EQ(defect(*frame), "");
  frame->width = 1281;
  EXPECT_THAT(defect(*frame), HasSubstr("1281x240"));
  frame = good_frame();
  frame->intrinsics[0] = 0;
  EXPECT_THAT(defect(*frame), HasSubstr("fx 0"));
  frame = good_frame();
  frame->depth_scale_m = std::nan("");
  EXPECT_THAT(defect(*frame), HasSubstr("depth scale"));
  frame = good_frame();
  frame->distortion[2] = std::nan("");
  EXPECT_THAT(defect(*frame), HasSubstr("distortion"));
}

TEST(FrameMessages, refuses_times_that_no_sensor_has) {
  const auto is_refused = [](msg::Unaligned<double> msg::RgbdFrame::*field, double time_s) {
    auto frame = good_frame();
    *frame.*field = time_s;
    return !defect(*frame).empty();
  };
  for (const auto field : {&msg::RgbdFrame::readout_s, &msg::RgbdFrame::depth_offset_s}) {
    EXPECT_FALSE(is_refused(field, -0.1));
    EXPECT_FALSE(is_refused(field, 0.1));
    EXPECT_TRUE(is_refused(field, 0.11));
    EXPECT_TRUE(is_refused(field, std::nan("")));
    EXPECT_TRUE(is_refused(field, -std::numeric_limits<double>::infinity()));
  }
}

TEST(FrameMessages, hand_on_the_times_of_the_sensor) {
  auto frame = good_frame();
  frame->readout_s = 0.02;
  frame->depth_offset_s = -0.01;
  const vision::RgbdImage image = vision::view_image(*frame);
  EXPECT_EQ(image.readout_s, 0.02);
  EXPECT_EQ(image.depth_offset_s, -0.01);
  const auto message = std::make_unique<msg::FeatureFrame>();
  fill_message(*frame, {}, msg::DetectionUse::kNone, *message);
  EXPECT_EQ(message->readout_s, 0.02);
}

TEST(FrameMessages, views_rows_of_the_frame_width) {
  auto frame = good_frame();
  frame->depth[320 * 2 + 5] = 777;
  const vision::RgbdImage image = vision::view_image(*frame);
  EXPECT_EQ(image.depth.at<std::uint16_t>(2, 5), 777);
  EXPECT_EQ(image.color_bgr.size(), cv::Size(320, 240));
}

TEST(FrameMessages, leaves_out_removed_features_first) {
  FilterResult result;
  for (std::uint32_t i = 0; i < 2 * msg::kMaxFeatures - 1000; ++i) {
    msg::Feature feature{};
    feature.flags = i % 2 == 0 ? msg::kFeatureRemoved : 0;
    result.features.push_back(feature);
  }
  const auto frame = good_frame();
  const auto message = std::make_unique<msg::FeatureFrame>();
  fill_message(*frame, result, msg::DetectionUse::kExact, *message);
  EXPECT_EQ(message->count, msg::kMaxFeatures - 500);
  EXPECT_EQ(message->removed, 0U);
  result.features.resize(100);
  fill_message(*frame, result, msg::DetectionUse::kExact, *message);
  EXPECT_EQ(message->count, 100U);
  EXPECT_EQ(message->removed, 50U);
}

TEST(FrameMessages, name_what_is_wrong_with_a_frame) {
  const auto frame = std::make_unique<msg::RgbdFrame>();
  *frame = {};
  frame->width = 640;
  frame->height = 480;
  frame->intrinsics = {525, 525, 320, 240};
  frame->depth_scale_m = 0.0002;
  EXPECT_EQ(defect(*frame), "");
  frame->intrinsics[1] = kNan;
  EXPECT_THAT(defect(*frame), testing::HasSubstr("intrinsics"));
  frame->intrinsics[1] = 525;
  frame->depth_scale_m = 0;
  EXPECT_THAT(defect(*frame), testing::HasSubstr("depth scale"));
  frame->depth_scale_m = 0.0002;
  frame->width = 5000;
  EXPECT_THAT(defect(*frame), testing::HasSubstr("5000"));
}

TEST(FrameMessages, show_the_motion_of_the_cells_as_a_grey_image) {
  const auto frame = std::make_unique<msg::RgbdFrame>();
  *frame = {};
  frame->stamp_ns = 1'500'000'000;
  frame->width = 640;
  frame->height = 480;
  FilterResult result;
  EXPECT_EQ(make_mask(*frame, result).data, std::vector<std::uint8_t>(160 * 120, 0)) << "mode off: all is static";
  result.cells = {3, 2};
  result.motion.assign(6, CellMotion::kUnknown);
  result.motion[4] = CellMotion::kDynamic;
  const msg::Image mask = make_mask(*frame, result);
  EXPECT_EQ(msg::to_ns(mask.header.stamp), 1'500'000'000);
  EXPECT_EQ(mask.encoding, "mono8");
  EXPECT_EQ(mask.width, 3U);
  EXPECT_EQ(mask.height, 2U);
  EXPECT_EQ(mask.step, 3U);
  EXPECT_THAT(mask.data, testing::ElementsAre(128, 128, 128, 128, 255, 128));
}

TEST(SlamMessages, give_poses_of_tracked_frames_only) {
  msg::TrackingResult result{};
  result.seq = 5;
  result.map_id = 2;
  result.T_world_camera.rotation_xyzw = {0, 0, 0, 1};
  result.T_world_camera.translation_m = {4, 5, 6};
  result.state = msg::TrackingState::kOk;
  const auto pose = to_slam_pose(result);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->seq, 5U);
  EXPECT_EQ(pose->map_id, 2U);
  EXPECT_EQ(pose->T_world_camera.translation(), Eigen::Vector3d(4, 5, 6));
  result.state = msg::TrackingState::kLost;
  EXPECT_FALSE(to_slam_pose(result));
}

}  // namespace
}  // namespace rtd::filter
