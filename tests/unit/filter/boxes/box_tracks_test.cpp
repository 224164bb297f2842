// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/box_tracks.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>

namespace rtd::filter {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kFrameNs = 33'333'333;

std::int64_t stamp(int frame) {
  return 1'000'000'000 + frame * kFrameNs;
}
vision::Detection person(double x_px, float score = 0.8F) {
  return {"person", score, static_cast<float>(x_px), 100, 80, 200};
}
double no_depth(std::int64_t /*stamp_ns*/, const vision::Detection& /*box*/) {
  return 0;
}

/// Tracks in a 640x480 image; frames are numbered.
class BoxTracksTest : public ::testing::Test {
 protected:
  void frame(int number) { tracks_.begin_frame({stamp(number), 640, 480}); }
  void answer(int number, std::vector<vision::Detection> detections) {
    tracks_.update({stamp(number), std::move(detections)}, no_depth);
  }
  /// Frames first..last, with the detector's answer for each.
  void walk(int first, int last, double step_px) {
    for (int i = first; i <= last; ++i) {
      frame(i);
      answer(i, {person(100 + step_px * i)});
      tracks_.boxes();
    }
  }
  void silence(int first, int last) {
    for (int i = first; i <= last; ++i) {
      frame(i);
      tracks_.boxes();
    }
  }
  void denial(int first, int last) {
    for (int i = first; i <= last; ++i) {
      frame(i);
      answer(i, {});
      tracks_.boxes();
    }
  }
  double x_px() { return static_cast<double>(tracks_.boxes().at(0).detection.x_px); }

  BoxTracks tracks_{BoxTrackConfig{}};
};

TEST_F(BoxTracksTest, give_a_moving_person_one_number) {
  walk(0, 20, 4);
  const auto boxes = tracks_.boxes();
  ASSERT_THAT(boxes, SizeIs(1));
  EXPECT_EQ(boxes[0].id, 0);
  EXPECT_FALSE(boxes[0].carried);
  EXPECT_NEAR(boxes[0].age_s, 20 / 30.0, 1e-6) << "s";
  EXPECT_FLOAT_EQ(boxes[0].detection.x_px, 180) << "the detector's own box";
}

TEST_F(BoxTracksTest, survive_misses_and_move_on) {
  walk(0, 10, 4);
  denial(11, 16);
  const auto boxes = tracks_.boxes();
  ASSERT_THAT(boxes, SizeIs(1));
  EXPECT_TRUE(boxes[0].carried);
  EXPECT_NEAR(x_px(), 100 + 4 * 16, 6) << "px";
}

TEST_F(BoxTracksTest, survive_no_longer_than_they_have_been_seen) {
  walk(0, 3, 0);
  denial(4, 5);
  EXPECT_THAT(tracks_.boxes(), SizeIs(1)) << "two misses after 0.1 s";
  denial(6, 8);
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

TEST_F(BoxTracksTest, survive_one_miss_however_short_they_have_been_seen) {
  walk(0, 1, 0);
  denial(2, 2);
  EXPECT_THAT(tracks_.boxes(), SizeIs(1));
}

TEST_F(BoxTracksTest, do_not_accumulate_when_a_detector_is_wrong) {
  std::minstd_rand random(1);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  constexpr int kFrames = 300, kLies = 3;
  std::size_t carried = 0;
  for (int i = 0; i < kFrames; ++i) {
    frame(i);
    std::vector<vision::Detection> lies;
    for (int k = 0; k < kLies; ++k) {
      const double width_px = between(20, 380), height_px = between(15, 430);
      lies.push_back({"person", 0.5F, static_cast<float>(between(0, 640 - width_px)),
                      static_cast<float>(between(0, 480 - height_px)), static_cast<float>(width_px),
                      static_cast<float>(height_px)});
    }
    answer(i, lies);
    for (const TrackedBox& box : tracks_.boxes()) carried += box.carried ? 1 : 0;
  }
  EXPECT_LE(static_cast<double>(carried) / kFrames, 2.0);
}

/// The upper half of a box has label 1, and no place another.
vision::PersonMasks upper_half_of(const vision::Detection& box) {
  vision::PersonMasks masks{160, 120, std::vector<std::uint8_t>(160 * 120, 0)};
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const auto x_px = static_cast<float>(4 * column + 2), y_px = static_cast<float>(4 * row + 2);
      const bool inside =
          x_px > box.x_px && x_px < box.x_px + box.width_px && y_px > box.y_px && y_px < box.y_px + box.height_px / 2;
      if (inside) masks.labels[static_cast<std::size_t>(row * 160 + column)] = 1;
    }
  }
  return masks;
}

TEST_F(BoxTracksTest, carry_the_newest_mask_with_their_box_but_not_for_long) {
  for (int i = 0; i <= 10; ++i) {
    frame(i);
    const vision::Detection seen = person(100 + 4 * i);
    tracks_.update({stamp(i), {seen}, upper_half_of(seen)}, no_depth);
    tracks_.boxes();
  }
  silence(11, 15);
  const TrackedBox carried = tracks_.boxes().at(0);
  const vision::Detection& now = carried.detection;
  const Eigen::Vector2d middle_px(now.x_px + now.width_px / 2, now.y_px + now.height_px / 2);
  EXPECT_TRUE(carried.carried);
  EXPECT_TRUE(carried.mask.covers(middle_px - Eigen::Vector2d(0, 40), now));
  EXPECT_FALSE(carried.mask.covers(middle_px + Eigen::Vector2d(0, 40), now));
  silence(16, 20);
  EXPECT_TRUE(tracks_.boxes().at(0).mask.empty()) << "after a third of a second";
}

TEST_F(BoxTracksTest, take_late_masks_but_not_older_ones) {
  walk(0, 3, 0);
  frame(4);
  frame(5);
  tracks_.update({stamp(4), {person(100)}, upper_half_of(person(100))}, no_depth);
  EXPECT_FALSE(tracks_.boxes().at(0).mask.empty());
  EXPECT_TRUE(tracks_.boxes().at(0).carried);
}

TEST_F(BoxTracksTest, have_no_mask_without_a_place_of_their_own) {
  frame(0);
  tracks_.update({stamp(0), {person(400), person(100)}, upper_half_of(person(400))}, no_depth);
  for (const TrackedBox& box : tracks_.boxes()) EXPECT_EQ(box.mask.empty(), box.detection.x_px < 200);
}

TEST_F(BoxTracksTest, end_after_repeated_empty_batches) {
  walk(0, 10, 0);
  denial(11, 40);
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

TEST_F(BoxTracksTest, forget_at_once_what_was_seen_only_once) {
  walk(0, 0, 0);
  EXPECT_THAT(tracks_.boxes(), SizeIs(1));
  silence(1, 3);
  EXPECT_THAT(tracks_.boxes(), SizeIs(1)) << "no answer yet";
  denial(4, 4);
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

TEST_F(BoxTracksTest, survive_a_second_without_batches_but_not_for_ever) {
  walk(0, 10, 0);
  silence(11, 40);
  EXPECT_THAT(tracks_.boxes(), SizeIs(1));
  silence(41, 70);
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

TEST_F(BoxTracksTest, compare_a_late_batch_with_their_state_at_that_time) {
  walk(0, 10, 4);
  silence(11, 20);
  answer(14, {person(100 + 4 * 14 + 20)});  // it had hurried
  ASSERT_THAT(tracks_.boxes(), SizeIs(1));
  EXPECT_EQ(tracks_.boxes()[0].id, 0);
  EXPECT_GT(x_px(), 100 + 4 * 20 + 15) << "px: the correction is carried to now";
}

TEST_F(BoxTracksTest, carry_new_objects_of_a_late_batch_forward) {
  silence(0, 10);
  answer(4, {person(100)});
  ASSERT_THAT(tracks_.boxes(), SizeIs(1));
  EXPECT_TRUE(tracks_.boxes()[0].carried);
  int steps = 0;
  tracks_.carry([&](const CarryStep& step) {
    EXPECT_EQ(step.from_ns, stamp(4 + steps));
    ++steps;
    return CarriedBox{{{3, 0}, 1}, 2.0};
  });
  EXPECT_EQ(steps, 6);
  EXPECT_NEAR(x_px(), 100 + 6 * 3, 1) << "px";
  EXPECT_EQ(tracks_.boxes()[0].depth_m, 2.0);
}

TEST_F(BoxTracksTest, measure_the_flow_of_each_step_once_and_not_of_detected_boxes) {
  walk(0, 5, 2);
  int asked = 0;
  const auto count = [&](const CarryStep&) {
    ++asked;
    return std::optional<CarriedBox>();
  };
  tracks_.carry(count);
  EXPECT_EQ(asked, 0);
  silence(6, 6);
  tracks_.carry(count);
  tracks_.carry(count);
  EXPECT_EQ(asked, 1);
}

TEST_F(BoxTracksTest, keep_the_flow_when_a_late_batch_changes_the_past) {
  walk(0, 5, 0);
  for (int i = 6; i <= 12; ++i) {
    frame(i);
    tracks_.carry([](const CarryStep&) { return CarriedBox{{{5, 0}, 1}, 0}; });
  }
  const double before_px = x_px();
  answer(8, {person(100 + 15 + 10)});
  EXPECT_GT(x_px() - before_px, 2) << "px: part of what the box was off by then";
  EXPECT_LT(x_px() - before_px, 10) << "px";
}

TEST_F(BoxTracksTest, use_each_batch_once) {
  walk(0, 0, 0);
  answer(0, {person(100)});
  answer(0, {person(100)});
  EXPECT_THAT(tracks_.boxes(), SizeIs(1));
  denial(1, 1);
  EXPECT_THAT(tracks_.boxes(), IsEmpty()) << "the repetition did not confirm it";
}

TEST_F(BoxTracksTest, ignore_batches_of_the_future_and_of_long_ago) {
  silence(0, 40);
  answer(41, {person(100)});
  answer(1000, {person(100)});
  answer(2, {person(100)});
  answer(-1000, {person(100)});
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

TEST_F(BoxTracksTest, keep_two_crossing_people_apart) {
  for (int i = 0; i <= 40; ++i) {
    frame(i);
    answer(i, {person(100 + 8 * i), person(420 - 8 * i)});
  }
  const auto boxes = tracks_.boxes();
  ASSERT_THAT(boxes, SizeIs(2));
  EXPECT_EQ(boxes[0].id, 0);
  EXPECT_FLOAT_EQ(boxes[0].detection.x_px, 100 + 8 * 40);
}

TEST_F(BoxTracksTest, take_the_class_of_most_detections) {
  for (int i = 0; i < 6; ++i) {
    frame(i);
    vision::Detection d = person(100);
    if (i == 3 || i == 5) d.class_name = "teddy bear";
    answer(i, {d});
  }
  frame(6);
  ASSERT_THAT(tracks_.boxes(), SizeIs(1));
  EXPECT_EQ(tracks_.boxes()[0].detection.class_name, "person");
}

TEST_F(BoxTracksTest, distinguish_objects_at_different_depths) {
  double depth_m = 1.5;
  const auto depth_of = [&](std::int64_t, const vision::Detection&) { return depth_m; };
  frame(0);
  tracks_.update({stamp(0), {person(100)}}, depth_of);
  frame(1);
  depth_m = 4.0;
  tracks_.update({stamp(1), {person(145)}}, depth_of);  // overlaps by half a box
  EXPECT_NE(tracks_.boxes().back().id, 0);
}

TEST_F(BoxTracksTest, drop_what_has_left_the_image) {
  walk(0, 10, -10);
  silence(11, 25);
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

TEST_F(BoxTracksTest, stay_bounded_with_random_boxes) {
  for (int i = 0; i < 100; ++i) {
    frame(i);
    std::vector<vision::Detection> boxes;
    for (int k = 0; k < 64; ++k)
      boxes.push_back({"person", 0.5F, static_cast<float>((k * 97 + i * 131) % 600),
                       static_cast<float>((k * 57 + i * 31) % 400), 40, 60});
    answer(i, boxes);
    EXPECT_LE(tracks_.boxes().size(), BoxTracks::kMaxTracks);
  }
}

TEST_F(BoxTracksTest, end_when_the_stamp_jumps_to_the_end_of_time) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max(),
                         kMin = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t stamp_ns : {kMin, std::int64_t{0}, kMax}) {
    tracks_.begin_frame({stamp_ns, 640, 480});
    EXPECT_THAT(tracks_.boxes(), IsEmpty()) << stamp_ns;
    tracks_.update({stamp_ns, {person(100)}}, no_depth);
    EXPECT_THAT(tracks_.boxes(), SizeIs(1)) << stamp_ns;
  }
  tracks_.update({kMin, {person(100)}}, no_depth);
}

TEST_F(BoxTracksTest, are_reset_when_time_goes_back) {
  walk(0, 10, 0);
  frame(3);
  EXPECT_THAT(tracks_.boxes(), IsEmpty());
}

}  // namespace
}  // namespace rtd::filter
