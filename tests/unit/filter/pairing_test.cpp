// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <future>
#include <limits>

#include "services/filter/detection_inbox.hpp"
#include "services/filter/frame_messages.hpp"
#include "services/filter/slam_feedback.hpp"

namespace rtd::filter {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

vision::Detection person(float x_px) {
  return {"person", 0.9F, x_px, 10, 40, 80};
}
bool never() {
  return false;
}
bool at_once() {
  return true;
}

TEST(DetectionInbox, hands_out_by_stamp_what_is_not_newer_and_once) {
  DetectionInbox inbox;
  inbox.put({200, {person(2)}});
  inbox.put({100, {person(1)}});
  inbox.put({300, {person(3)}});
  const auto taken = inbox.take_until(200);
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].stamp_ns, 100);
  EXPECT_EQ(taken[1].detections.at(0).x_px, 2);
  EXPECT_TRUE(inbox.take_until(200).empty());
  EXPECT_EQ(inbox.take_until(1000).size(), 1U) << "it came before its frame";
}

TEST(DetectionInbox, waits_for_boxes_that_come_later) {
  DetectionInbox inbox;
  auto waiting = std::async(std::launch::async, [&] { return inbox.wait_for(300, never); });
  inbox.put({299, {}});
  inbox.put({300, {person(3)}});
  ASSERT_TRUE(waiting.get());
  EXPECT_EQ(inbox.take_until(300).size(), 2U);
}

TEST(DetectionInbox, gives_up_when_told_and_when_closed) {
  DetectionInbox inbox;
  EXPECT_FALSE(inbox.wait_for(1, at_once));
  auto waiting = std::async(std::launch::async, [&] { return inbox.wait_for(1, never); });
  inbox.close();
  EXPECT_FALSE(waiting.get());
}

TEST(DetectionInbox, is_not_blocked_by_stamps_of_the_far_future) {
  DetectionInbox inbox;
  for (int i = 0; i < 1000; ++i) inbox.put({1'000'000'000'000 + i, {person(1)}});
  inbox.put({100, {person(1)}});
  EXPECT_EQ(inbox.take_until(100).size(), 1U);
}

msg::Detection2D box(double centre_px, double size_px, double score) {
  msg::Detection2D detection;
  detection.bbox.center.position = {centre_px, centre_px};
  detection.bbox.size_x = detection.bbox.size_y = size_px;
  detection.results.push_back({{"cup", 0.1}, {}});
  detection.results.push_back({{"person", score}, {}});
  return detection;
}

TEST(DetectionMessage, takes_the_best_hypothesis_and_the_corner_of_the_box) {
  msg::Detection2DArray message;
  message.header.stamp = {1, 5};
  message.detections = {box(50, 20, 0.8)};
  const DetectorAnswer converted = from_message(message);
  EXPECT_EQ(converted.stamp_ns, 1'000'000'005);
  ASSERT_EQ(converted.detections.size(), 1U);
  EXPECT_EQ(converted.detections[0].class_name, "person");
  EXPECT_FLOAT_EQ(converted.detections[0].x_px, 40.0F);
}

TEST(DetectionMessage, leaves_out_boxes_that_are_none) {
  msg::Detection2DArray message;
  message.detections = {box(std::nan(""), 20, 0.8), box(50, 0, 0.8), box(50, -3, 0.8),
                        box(50, std::numeric_limits<double>::infinity(), 0.8), msg::Detection2D{}};
  EXPECT_THAT(from_message(message).detections, IsEmpty());
}

TEST(DetectionMessage, of_ten_thousand_boxes_the_best_are_kept) {
  msg::Detection2DArray message;
  for (int i = 0; i < 10'000; ++i) message.detections.push_back(box(50, 20, 0.2 + 0.00005 * i));
  const auto kept = from_message(message).detections;
  EXPECT_EQ(kept.size(), 300U);
  EXPECT_GT(kept.back().score, 0.68F);
}

msg::TrackingResult result(std::uint64_t seq, std::uint64_t event_count) {
  msg::TrackingResult result{};
  result.seq = seq;
  result.event_count = event_count;
  return result;
}
msg::KeyframeEvent event(std::uint64_t index) {
  msg::KeyframeEvent event{};
  event.event_index = index;
  return event;
}

TEST(SlamFeedback, is_complete_only_with_all_events_of_the_frame) {
  SlamFeedback feedback;
  feedback.put(result(7, 2));
  feedback.put(event(0));
  EXPECT_FALSE(feedback.take_after(7, 1ms).complete);
  feedback.put(event(1));
  const SlamWords words = feedback.take_after(7, 1ms);
  EXPECT_TRUE(words.complete);
  EXPECT_EQ(words.events.size(), 1U) << "the first event was taken before";
}

TEST(SlamFeedback, waits_for_the_frame_asked_for) {
  SlamFeedback feedback;
  feedback.put(result(6, 0));
  auto waiting = std::async(std::launch::async, [&] { return feedback.take_after(7, 5s); });
  feedback.put(result(7, 0));
  EXPECT_TRUE(waiting.get().complete);
}

TEST(SlamFeedback, a_restarted_slam_counts_its_events_from_zero) {
  SlamFeedback feedback;
  feedback.put(event(41));
  feedback.put(result(7, 42));
  EXPECT_TRUE(feedback.take_after(7, 1ms).complete);
  feedback.put(result(8, 1));
  feedback.put(event(0));
  EXPECT_TRUE(feedback.take_after(8, 1ms).complete);
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
  frame->width = 1280;
  EXPECT_THAT(defect(*frame), HasSubstr("1280x240"));
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

TEST(FrameMessages, views_rows_of_the_frame_width) {
  auto frame = good_frame();
  frame->depth[320 * 2 + 5] = 777;
  const vision::RgbdImage image = view_image(*frame);
  EXPECT_EQ(image.depth.at<std::uint16_t>(2, 5), 777);
  EXPECT_EQ(image.color_bgr.size(), cv::Size(320, 240));
}

TEST(FrameMessages, leaves_out_removed_features_first) {
  FilterResult result;
  for (int i = 0; i < 3000; ++i) {
    msg::Feature feature{};
    feature.flags = i % 2 == 0 ? msg::kFeatureRemoved : 0;
    result.features.push_back(feature);
  }
  const auto frame = good_frame();
  const auto message = std::make_unique<msg::FeatureFrame>();
  fill_message(*frame, result, msg::DetectionUse::kExact, *message);
  EXPECT_EQ(message->count, 1500U);
  EXPECT_EQ(message->removed, 0U);
  result.features.resize(100);
  fill_message(*frame, result, msg::DetectionUse::kExact, *message);
  EXPECT_EQ(message->count, 100U);
  EXPECT_EQ(message->removed, 50U);
}

}  // namespace
}  // namespace rtd::filter
