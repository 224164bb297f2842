// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/left_out.hpp"

#include <gmock/gmock.h>

namespace rtd::camera {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

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
