// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/place_policy.hpp"

#include <gtest/gtest.h>

#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;

/// Frames at 30 Hz; every frame that is due is asked about.
class PlacePolicyTest : public testing::Test {
 protected:
  /// How many frames of the next `duration_s` are asked about.
  int play(double duration_s, TrackingState state, std::uint32_t map_id = 0) {
    int queries = 0;
    for (const std::int64_t end_ns = now_ns_ + msg::ns_of(duration_s); now_ns_ < end_ns;) {
      now_ns_ += kPeriodNs;
      msg::TrackingResult result{};
      result.stamp_ns = now_ns_;
      result.state = state;
      result.map_id = map_id;
      policy_.update(result);
      if (!policy_.due()) continue;
      policy_.note_query();
      last_query_ns_ = now_ns_;
      ++queries;
    }
    return queries;
  }

  static constexpr std::int64_t kPeriodNs = 33'333'333;
  PlacePolicy policy_;
  std::int64_t now_ns_ = 1'000'000'000, last_query_ns_ = 0;
};

TEST_F(PlacePolicyTest, asks_twice_a_second_until_a_map_has_grown_for_three_seconds) {
  EXPECT_EQ(play(1, TrackingState::kOk), 2);
  EXPECT_EQ(play(2, TrackingState::kOk), 4);
  EXPECT_FALSE(policy_.wanted());
  EXPECT_EQ(play(20, TrackingState::kOk), 0);
}

TEST_F(PlacePolicyTest, asks_for_ten_seconds_where_no_map_begins) {
  EXPECT_EQ(play(10, TrackingState::kInitializing), 19);
  EXPECT_EQ(play(20, TrackingState::kInitializing), 0);
}

TEST_F(PlacePolicyTest, asks_nothing_in_a_loaded_map_but_after_a_reset) {
  policy_.begin_map(true);
  EXPECT_EQ(play(5, TrackingState::kRelocalizing), 0);
  EXPECT_EQ(play(5, TrackingState::kOk), 0);
  policy_.begin_map(false);
  EXPECT_EQ(play(1, TrackingState::kOk), 2);
}

TEST_F(PlacePolicyTest, asks_while_the_camera_is_lost_for_more_than_a_moment) {
  play(20, TrackingState::kOk);
  EXPECT_EQ(play(1, TrackingState::kRecentlyLost), 0);
  EXPECT_EQ(play(0.5, TrackingState::kLost), 0);
  EXPECT_EQ(play(20, TrackingState::kLost), 38);
  EXPECT_EQ(play(1, TrackingState::kOk), 0);
  EXPECT_EQ(play(0.5, TrackingState::kLost), 0) << "the moment begins again";
}

TEST_F(PlacePolicyTest, takes_answers_to_its_last_queries_about_this_map) {
  play(1, TrackingState::kOk);
  EXPECT_TRUE(policy_.is_answer(last_query_ns_));
  EXPECT_FALSE(policy_.is_answer(last_query_ns_ - kPeriodNs));
  policy_.begin_map(false);
  EXPECT_FALSE(policy_.is_answer(last_query_ns_)) << "of the map before";
  play(20, TrackingState::kOk);
  play(1.1, TrackingState::kLost);
  const std::int64_t first_ns = last_query_ns_;
  play(3, TrackingState::kLost);
  EXPECT_TRUE(policy_.is_answer(first_ns));
  play(10, TrackingState::kLost);
  EXPECT_FALSE(policy_.is_answer(first_ns)) << "long ago";
}

TEST_F(PlacePolicyTest, a_map_in_which_the_camera_is_found_is_kept) {
  play(1, TrackingState::kOk);
  policy_.take(1);
  EXPECT_EQ(play(2, TrackingState::kRelocalizing), 0);
  EXPECT_EQ(play(20, TrackingState::kOk), 0);
  EXPECT_FALSE(policy_.failed());
  EXPECT_GT(play(2, TrackingState::kLost), 0) << "it asks again";
}

TEST_F(PlacePolicyTest, a_map_in_which_the_camera_is_not_found_fails_and_none_is_taken_for_a_while) {
  play(1, TrackingState::kOk);
  policy_.take(1);
  play(2.9, TrackingState::kRelocalizing);
  EXPECT_FALSE(policy_.failed());
  play(0.2, TrackingState::kRelocalizing);
  ASSERT_TRUE(policy_.failed());
  policy_.begin_map(false);
  policy_.pause();
  EXPECT_FALSE(policy_.failed());
  EXPECT_EQ(play(9.9, TrackingState::kLost), 0);
  EXPECT_GT(play(1, TrackingState::kLost), 0);
}

TEST_F(PlacePolicyTest, a_map_fails_when_the_camera_begins_another_next_to_it) {
  play(1, TrackingState::kOk);
  policy_.take(2);
  play(0.1, TrackingState::kOk, 2);
  EXPECT_TRUE(policy_.failed());
}

TEST_F(PlacePolicyTest, a_source_that_starts_again_does_not_make_the_map_new) {
  play(20, TrackingState::kOk);
  now_ns_ = 0;
  EXPECT_EQ(play(5, TrackingState::kOk), 0);
  EXPECT_GT(play(2, TrackingState::kLost), 0);
}

}  // namespace
}  // namespace rtd::slam
