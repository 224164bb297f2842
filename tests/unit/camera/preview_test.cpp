// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "common/camera/open/source_factory.hpp"
#include "services/camera/core/left_out.hpp"
#include "services/camera/core/preview.hpp"

namespace rtd::camera {
namespace {

using ::testing::HasSubstr;
using namespace ::testing;

Preview preview_of(const std::string& uri) {
  const auto source = make_source(uri);
  Preview preview;
  while (const auto frame = source->next()) preview.add(*frame);
  return preview;
}

/// A grey box in front of a wall; its depth lies `shift` beside its colour.
SourceFrame box(cv::Point shift, double stamp_s = 1, double offset_s = 0) {
  SourceFrame frame;
  frame.image.stamp_ns = static_cast<std::int64_t>(stamp_s * 1e9);
  frame.image.depth_offset_s = offset_s;
  frame.image.color_bgr = cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(60));
  frame.image.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(3000));
  const cv::Rect place(50, 40, 60, 45);
  cv::rectangle(frame.image.color_bgr, place, cv::Scalar::all(180), cv::FILLED);
  cv::rectangle(frame.image.depth, place + shift, cv::Scalar(1500), cv::FILLED);
  return frame;
}

TEST(PreviewTest, measures_rate_holes_and_time_between_the_images) {
  Preview preview;
  for (int i = 0; i < 16; ++i) {
    SourceFrame frame = box({}, 1 + i / 15.0, 0.009);
    frame.image.depth.rowRange(0, 30) = 0;
    preview.add(frame);
  }
  EXPECT_NEAR(preview.rate_hz(), 15, 1e-6);
  EXPECT_NEAR(preview.hole_share(), 0.25, 1e-9);
  EXPECT_NEAR(preview.depth_offset_s(), 0.009, 1e-9);
  EXPECT_EQ(preview.picture().size(), cv::Size(320, 120));
  EXPECT_THAT(preview.text({}, {}), HasSubstr("25.0 % of the depth image"));
}

TEST(PreviewTest, says_how_far_away_depth_is_and_doubts_its_unit) {
  Preview preview;
  SourceFrame frame = box({});
  frame.image.depth_scale_m = 1.0 / 5000;
  preview.add(frame);
  const std::string text = preview.text({.depth_scale_m = 1.0 / 5000, .depth_unit_given = false}, {});
  EXPECT_THAT(text, HasSubstr("median 0.6"));
  EXPECT_THAT(text, testing::Not(HasSubstr("WARNING"))) << "a shelf in front of the camera, or 3 m";
  Preview near;
  frame.image.depth /= 2;
  near.add(frame);
  EXPECT_THAT(near.text({.depth_scale_m = 1.0 / 5000, .depth_unit_given = false}, {}),
              testing::AllOf(HasSubstr("WARNING"), HasSubstr("millimetres"), HasSubstr("?depth_factor=1000")));
}

TEST(PreviewTest, measures_how_far_depth_lies_beside_colour) {
  for (const cv::Point shift : {cv::Point(0, 0), cv::Point(7, -3), cv::Point(-9, 4)}) {
    Preview preview;
    for (int i = 0; i < 16; ++i) preview.add(box(shift, 1 + i / 15.0));
    const std::optional<cv::Point2d> measured = preview.registration_px();
    ASSERT_TRUE(measured) << shift;
    EXPECT_NEAR(measured->x, shift.x, 0.7);
    EXPECT_NEAR(measured->y, shift.y, 0.7);
  }
}

TEST(PreviewTest, a_rendered_room_shows_the_shift_of_its_depth) {
  const auto aligned = preview_of("synthetic:office?frames=30&width=320&height=240").registration_px();
  const auto shifted =
      preview_of("synthetic:office?frames=30&width=320&height=240&registration_px=5").registration_px();
  ASSERT_TRUE(aligned && shifted);
  EXPECT_LT(std::hypot(aligned->x, aligned->y), 1.5);
  EXPECT_NEAR(std::hypot(shifted->x - aligned->x, shifted->y - aligned->y), 5, 1);
}

TEST(PreviewTest, a_bare_wall_gives_no_shift) {
  Preview preview;
  SourceFrame frame = box({});
  frame.image.depth = 2000;
  preview.add(frame);
  EXPECT_FALSE(preview.registration_px());
  EXPECT_THAT(preview.text({}, {}), HasSubstr("not measured in px"));
}

SourceCounters skipped(SkipReason reason, std::uint64_t count) {
  SourceCounters counters;
  counters.skipped.at(static_cast<std::size_t>(reason)) = count;
  return counters;
}

ReadItem end_of_source(const SourceCounters& counters) {
  ReadItem item;
  item.counters = counters;
  return item;
}

vision::RgbdImage image_of(std::uint16_t depth) {
  vision::RgbdImage image;
  image.depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(depth));
  image.depth_scale_m = 0.001;
  return image;
}

TEST(LeftOut, counts_what_a_list_left_out_by_the_share_that_was_played) {
  const SourceCounters of_the_list = skipped(SkipReason::kStampBackwards, 40);
  LeftOut left_out;
  left_out.open(100, 25, of_the_list);
  left_out.add(end_of_source(of_the_list));
  EXPECT_EQ(left_out.counters(25).frames_left_out(), 10U) << "--frames 25 has met a quarter of the list";

  LeftOut whole;
  whole.open(100, 0, of_the_list);
  whole.add(end_of_source(skipped(SkipReason::kStampBackwards, 45)));
  EXPECT_EQ(whole.counters(95).frames_left_out(), 45U) << "at the end all of it counts";
  EXPECT_THAT(whole.metrics(95), Contains(Pair("frames_left_out", 45U)));
  EXPECT_THAT(whole.metrics(95), Contains(Pair("left_out.stamp_backwards", 45U)));
}

TEST(LeftOut, counts_from_where_an_earlier_process_stopped) {
  const SourceCounters of_the_list = skipped(SkipReason::kStampBackwards, 40);
  const SourceCounters passed = skipped(SkipReason::kStampBackwards, 43),
                       at_the_end = skipped(SkipReason::kStampBackwards, 45);
  LeftOut left_out;
  left_out.open(100, 0, of_the_list);
  left_out.resume(25, passed);
  EXPECT_EQ(left_out.counters(25).frames_left_out(), 0U);
  left_out.add(end_of_source(at_the_end));
  EXPECT_EQ(left_out.counters(95).frames_left_out(), 32U) << "three quarters of the list, and two of 45";
}

TEST(LeftOut, colour_at_twice_the_rate_of_depth_leaves_nothing_out) {
  SourceCounters counters = skipped(SkipReason::kNoDepthPartner, 50);
  EXPECT_EQ(counters.frames_left_out(), 0U);
  counters.depth_alone = 20;
  EXPECT_EQ(counters.frames_left_out(), 20U) << "so many pairs could have been";
}

TEST(LeftOut, a_frame_whose_depth_is_nowhere_in_range_is_of_no_use) {
  LeftOut left_out;
  for (const std::uint16_t depth : {0, 50, 1500, 21000}) left_out.add(image_of(depth));
  EXPECT_THAT(left_out.metrics(4), Contains(Pair("frames_out_of_range", 3U)));
}

TEST(LeftOut, keeps_the_first_piece_for_people) {
  LeftOut left_out;
  EXPECT_THAT(left_out.first(), IsEmpty());
  ReadItem item;
  item.skipped = {{SkipReason::kSizeMismatch, "rgb/7.png: sizes differ"}, {SkipReason::kSizeMismatch, "rgb/8.png"}};
  left_out.add(item);
  left_out.add(item);
  EXPECT_EQ(left_out.first(), "rgb/7.png: sizes differ");
}

TEST(SkipReason, each_is_explained_and_found_by_its_name) {
  for (std::size_t i = 0; i < kSkipReasons; ++i) {
    const auto reason = static_cast<SkipReason>(i);
    EXPECT_EQ(skip_reason_of(to_string(reason)), reason);
    EXPECT_THAT(explain(reason), HasSubstr(": ")) << "cause: remedy";
  }
  EXPECT_FALSE(skip_reason_of("no_such_reason"));
}

}  // namespace
}  // namespace rtd::camera
