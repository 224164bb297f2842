// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/view_store.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace rtd::filter {
namespace {

constexpr std::int64_t kPeriodNs = 33'000'000;

Eigen::Isometry3d at(double x_m) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = x_m;
  return T;
}
View view(std::uint64_t seq, double x_m = 0) {
  View view;
  view.seq = seq;
  view.stamp_ns = static_cast<std::int64_t>(seq) * kPeriodNs;
  view.T_world_camera = at(x_m);
  return view;
}
std::int64_t stamp(std::uint64_t seq) {
  return static_cast<std::int64_t>(seq) * kPeriodNs;
}

TEST(ViewStore, is_bounded_and_keeps_a_second_at_any_rate) {
  for (const std::int64_t period_ns : {4'000'000, 16'600'000, 33'300'000, 200'000'000}) {
    ViewStore store;
    View last;
    for (std::uint64_t seq = 0; seq < 1000; ++seq) {
      last = view(seq);
      last.stamp_ns = static_cast<std::int64_t>(seq) * period_ns;
      store.add(last);
      store.mark_keyframe(seq, at(0));
    }
    EXPECT_LE(store.size(), ViewStore::kMaxRecent + ViewStore::kMaxPast + ViewStore::kMaxKeyframes) << period_ns;
    if (period_ns > 16'000'000) {
      EXPECT_TRUE(store.spans(last.stamp_ns, 1'000'000'000)) << period_ns;
    }
  }
}

TEST(ViewStore, stamps_at_the_ends_of_time_are_very_old_or_far_ahead) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max(),
                         kMin = std::numeric_limits<std::int64_t>::min();
  ViewStore store;
  View old = view(0), now = view(1, 0.01);
  old.stamp_ns = kMin;
  store.add(old);
  store.add(now);
  EXPECT_TRUE(store.spans(kMax, 1'000'000'000));
  EXPECT_FALSE(store.spans(kMin, 1));
  EXPECT_EQ(store.of_age(kMax, 0).seq, 1U);
  EXPECT_EQ(store.of_age(kMin, kPeriodNs).seq, 0U);
  EXPECT_EQ(store.long_ago(kMax, -1'000'000'000).seq, 1U);
  EXPECT_NEAR(store.predict_pose(kMax).translation().x(), 0.01, 1e-9) << "at rest after a long gap";
}

class ViewStoreTest : public testing::Test {
 protected:
  ViewStore store;
};

TEST_F(ViewStoreTest, predicts_by_the_stamps_of_the_frames) {
  store.add(view(0));
  EXPECT_NEAR(store.predict_pose(stamp(3)).translation().x(), 0, 1e-9) << "one view, no velocity";
  store.add(view(1, 0.01));
  EXPECT_NEAR(store.predict_pose(stamp(2)).translation().x(), 0.02, 1e-9);
  EXPECT_NEAR(store.predict_pose(stamp(4)).translation().x(), 0.04, 1e-9) << "two frames are missing";
  EXPECT_NEAR(store.predict_pose(stamp(100)).translation().x(), 0.01, 1e-9) << "after a long gap";
}

TEST_F(ViewStoreTest, keeps_a_view_from_longer_ago_than_the_recent_ones) {
  for (std::uint64_t seq = 0; seq < 120; ++seq) store.add(view(seq));
  EXPECT_NEAR(1e-9 * static_cast<double>(stamp(120) - store.long_ago(stamp(120), 1'500'000'000).stamp_ns), 1.5, 0.15);
  EXPECT_EQ(store.long_ago(stamp(120), 500'000'000).seq, 105U);
}

TEST_F(ViewStoreTest, forgets_what_is_long_ago_when_slam_starts_a_new_map) {
  for (std::uint64_t seq = 0; seq < 120; ++seq) store.add(view(seq));
  EXPECT_FALSE(store.correct(110, at(1.0)));
  EXPECT_EQ(store.long_ago(stamp(120), 3'000'000'000).seq, 110U);
}

TEST_F(ViewStoreTest, lets_later_views_follow_a_correction) {
  for (std::uint64_t seq = 0; seq < 4; ++seq) store.add(view(seq, 0.1 * static_cast<double>(seq)));
  EXPECT_TRUE(store.correct(1, at(0.15)));
  EXPECT_NEAR(store.newest().T_world_camera.translation().x(), 0.35, 1e-9) << "m";
  EXPECT_TRUE(store.correct(3, at(0.3)));
  EXPECT_NEAR(store.second_newest()->T_world_camera.translation().x(), 0.25, 1e-9) << "m: earlier ones stay";
}

TEST_F(ViewStoreTest, drops_what_lies_in_another_world) {
  for (std::uint64_t seq = 0; seq < 10; ++seq) store.add(view(seq));
  store.mark_keyframe(2, at(0));
  EXPECT_FALSE(store.correct(7, at(5.0))) << "slam has started a new map";
  EXPECT_EQ(store.size(), 3U) << "7, 8 and 9";
  EXPECT_NEAR(store.newest().T_world_camera.translation().x(), 5.0, 1e-9) << "m";
}

TEST_F(ViewStoreTest, forgets_what_lies_before_a_frame) {
  for (std::uint64_t seq = 0; seq < 10; ++seq) store.add(view(seq));
  store.mark_keyframe(2, at(0));
  store.forget_before(6);
  EXPECT_EQ(store.size(), 4U) << "6 to 9";
  store.forget_before(77);
  EXPECT_EQ(store.size(), 1U) << "the newest view stays";
}

TEST_F(ViewStoreTest, ignores_frames_that_it_does_not_have) {
  EXPECT_TRUE(store.correct(3, at(1)));
  store.mark_keyframe(3, at(1));
  store.forget_keyframe(3);
  EXPECT_TRUE(store.empty());
  EXPECT_TRUE(store.references(0, at(0), {6}).empty());
}

TEST_F(ViewStoreTest, chooses_references_of_graded_ages) {
  for (std::uint64_t seq = 0; seq < 32; ++seq) store.add(view(seq));
  std::vector<std::uint64_t> seqs;
  for (const View* reference : store.references(stamp(32), at(0), {6})) seqs.push_back(reference->seq);
  EXPECT_THAT(seqs, testing::ElementsAre(29, 24, 15, 2)) << "0.1, 0.27, 0.55 and 1 s ago at 33 ms";
}

TEST_F(ViewStoreTest, adds_keyframes_that_look_the_same_way_from_near) {
  for (std::uint64_t seq = 0; seq < 60; ++seq) {
    store.add(view(seq));
    if (seq == 3) store.mark_keyframe(3, at(0.2));
    if (seq == 5) store.mark_keyframe(5, at(3.0));  // too far away
    if (seq == 50) store.mark_keyframe(50, at(0));  // among the recent ones anyway
  }
  const auto references = store.references(stamp(60), at(0), {6});
  ASSERT_EQ(references.size(), 5U);
  EXPECT_EQ(references.back()->seq, 3U);
  store.forget_keyframe(3);
  EXPECT_EQ(store.references(stamp(60), at(0), {6}).size(), 4U);
}

TEST_F(ViewStoreTest, uses_no_keyframe_beyond_the_largest_baseline) {
  for (std::uint64_t seq = 0; seq < 60; ++seq) {
    store.add(view(seq));
    if (seq == 3) store.mark_keyframe(3, at(0.5));
  }
  for (const double max_baseline_m : {0.4, 0.6}) {
    EXPECT_EQ(store.near_keyframes(at(0), {6, max_baseline_m}).size(), max_baseline_m < 0.5 ? 0U : 1U);
    EXPECT_EQ(store.references(stamp(60), at(0), {6, max_baseline_m}).size(), max_baseline_m < 0.5 ? 4U : 5U);
  }
}

TEST_F(ViewStoreTest, prefers_settled_views) {
  store.add(view(0));
  for (std::uint64_t seq = 1; seq < 3; ++seq) {
    store.add(view(seq));
  }
  View unsettled = view(3);
  unsettled.settled = false;
  store.add(unsettled);
  EXPECT_EQ(store.of_age(stamp(4), kPeriodNs).seq, 2U);
}

TEST_F(ViewStoreTest, views_move_along_when_slam_corrects_its_map) {
  for (std::uint64_t seq = 0; seq < 20; ++seq) store.add(view(seq, 0.1 * static_cast<double>(seq)));
  for (const std::uint64_t seq : {3U, 12U}) {
    store.mark_keyframe(seq, at(0.1 * static_cast<double>(seq)));
    store.correct(seq, at(0.1 * static_cast<double>(seq)));
  }
  EXPECT_TRUE(store.mark_keyframe(12, at(1.21))) << "local adjustment";
  EXPECT_NEAR(store.newest().T_world_camera.translation().x(), 1.9, 1e-9);
  EXPECT_FALSE(store.mark_keyframe(12, at(1.7))) << "half a metre: a loop was closed";
  EXPECT_TRUE(store.mark_keyframe(3, at(0.8))) << "the others are moved once";
  EXPECT_NEAR(store.newest().T_world_camera.translation().x(), 2.4, 1e-9);
  EXPECT_TRUE(store.correct(19, at(2.41))) << "and slam's next word fits";
  EXPECT_EQ(store.near_keyframes(at(0.8), {6, 0.05}).size(), 1U);
}

}  // namespace
}  // namespace rtd::filter
