// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <limits>

#include "services/filter/config.hpp"
#include "services/filter/detection_inbox.hpp"
#include "services/filter/frame_messages.hpp"
#include "services/filter/slam_feedback.hpp"

namespace rtd::filter {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

msg::Detection2D box(const char* name, double score, double x, double y, double width, double height) {
  msg::Detection2D detection;
  msg::ObjectHypothesisWithPose result;
  result.hypothesis = {name, score};
  detection.results = {result};
  detection.bbox = {{{x, y}, 0}, width, height};
  return detection;
}

TEST(DetectionMessage, becomes_boxes_with_their_corner) {
  msg::Detection2DArray message;
  message.header.stamp = msg::to_time(1'234'567'890);
  message.detections = {box("person", 0.8, 100, 200, 40, 60)};
  const DetectorAnswer boxes = from_message(message);
  EXPECT_EQ(boxes.stamp_ns, 1'234'567'890);
  ASSERT_EQ(boxes.detections.size(), 1U);
  EXPECT_FLOAT_EQ(boxes.detections[0].x_px, 80);
  EXPECT_FLOAT_EQ(boxes.detections[0].y_px, 170);
}

TEST(DetectionMessage, loses_what_makes_no_sense) {
  msg::Detection2DArray message;
  message.detections = {box("person", kNan, 1, 1, 1, 1),   box("person", 0.5, kInf, 1, 1, 1),
                        box("person", 0.5, 1, 1, kNan, 1), box("person", 0.5, 1, 1, -4, 1),
                        box("person", 0.5, 1, 1, 0, 0),    msg::Detection2D{}};
  EXPECT_TRUE(from_message(message).detections.empty());
  message.detections.assign(10'000, box("person", 0.5, 100, 100, 10, 10));
  message.detections[9'999].results[0].hypothesis.score = 0.9;
  const DetectorAnswer boxes = from_message(message);
  EXPECT_LE(boxes.detections.size(), 1000U);
  EXPECT_FLOAT_EQ(boxes.detections[0].score, 0.9F) << "the best are kept";
}

TEST(SlamFeedback, is_complete_with_the_result_and_all_events_before_it) {
  SlamFeedback feedback;
  const std::chrono::milliseconds no_time{0};
  msg::TrackingResult result{};
  result.seq = 4;
  result.event_count = 2;
  feedback.put(result);
  msg::KeyframeEvent event{};
  feedback.put(event);
  EXPECT_FALSE(feedback.take_after(4, no_time).complete);
  event.event_index = 1;
  feedback.put(event);
  EXPECT_TRUE(feedback.take_after(4, no_time).complete);
  EXPECT_TRUE(feedback.take().results.empty()) << "each word is given once";
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

TEST(FrameMessages, show_the_motion_of_the_cells_as_a_grey_picture) {
  const auto frame = std::make_unique<msg::RgbdFrame>();
  *frame = {};
  frame->stamp_ns = 1'500'000'000;
  frame->width = 12;
  frame->height = 8;
  FilterResult result;
  EXPECT_EQ(make_mask(*frame, result).data, std::vector<std::uint8_t>(6, 0)) << "mode off: all is static";
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

TEST(FilterConfig, is_bound_completely_and_refuses_what_is_out_of_range) {
  ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("filter", config);
  binder.set("filter.mode=geometry");
  binder.set("filter.geometry.tau_floor_m=0.4");
  EXPECT_EQ(config.core_config().mode, FilterMode::kGeometry);
  EXPECT_DOUBLE_EQ(config.core_config().geometry.tau_floor_m, 0.4);
  EXPECT_THROW(binder.set("filter.geometry.tau_floor_m=-1"), service::ConfigError);
  EXPECT_THROW(binder.set("filter.mode=magic"), service::ConfigError);
  EXPECT_THAT([&] { binder.set("filter.geometry.tau_flor_m=1"); },
              testing::ThrowsMessage<service::ConfigError>(testing::HasSubstr("tau_floor_m")));
}

}  // namespace
}  // namespace rtd::filter
