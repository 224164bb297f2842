// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/tracker.hpp"

#include <gtest/gtest.h>

namespace rtd::slam {
namespace {

/// Well tracked: 290 of 300 landmarks, plenty of close ones.
KeyframeSituation steady() {
  KeyframeSituation s;
  s.since_keyframe_s = 0.2;
  s.map_keyframes = 6;
  s.inliers = 290;
  s.reference_landmarks = 300;
  s.close_tracked = 200;
  s.close_untracked = 300;
  return s;
}

bool inserts(const KeyframeSituation& s) {
  return wants_keyframe(s, {});
}

TEST(KeyframePolicy, leaves_a_well_known_view_alone) {
  EXPECT_FALSE(inserts(steady()));
  KeyframeSituation overdue = steady();
  overdue.since_keyframe_s = 30;
  EXPECT_FALSE(inserts(overdue)) << "time alone makes no new view";
}

TEST(KeyframePolicy, inserts_when_the_view_is_new) {
  KeyframeSituation s = steady();
  s.inliers = 268;
  EXPECT_TRUE(inserts(s));
  s.inliers = 272;
  EXPECT_FALSE(inserts(s)) << "0.9 of the reference is still tracked";
}

TEST(KeyframePolicy, inserts_when_close_points_run_out) {
  KeyframeSituation s = steady();
  s.close_tracked = 99;
  s.close_untracked = 71;
  EXPECT_TRUE(inserts(s));
  s.close_untracked = 70;
  EXPECT_FALSE(inserts(s)) << "nothing there to make landmarks of";
}

TEST(KeyframePolicy, spares_a_busy_mapper_unless_tracking_is_weak) {
  KeyframeSituation s = steady();
  s.mapper_idle = false;
  s.inliers = 200;
  EXPECT_FALSE(inserts(s));
  s.since_keyframe_s = 1;
  EXPECT_TRUE(inserts(s)) << "overdue";
  s.since_keyframe_s = 0.2;
  s.inliers = 70;
  EXPECT_TRUE(inserts(s)) << "weak";
}

TEST(KeyframePolicy, makes_no_keyframe_of_a_bad_pose) {
  KeyframeSituation s = steady();
  s.inliers = 15;
  EXPECT_FALSE(inserts(s));
  s.inliers = 16;
  EXPECT_TRUE(inserts(s));
}

TEST(KeyframePolicy, waits_longer_while_the_map_is_one_keyframe) {
  KeyframeSituation s = steady();
  s.map_keyframes = 1;
  s.inliers = 150;
  EXPECT_FALSE(inserts(s));
  s.inliers = 119;
  EXPECT_TRUE(inserts(s));
}

TEST(KeyframePolicy, a_view_that_is_mostly_unknown_is_new_whatever_its_reference) {
  KeyframeSituation s = steady();
  s.inliers = s.reference_landmarks = 50;
  s.close_tracked = 100;
  EXPECT_FALSE(inserts(s));
  s.mostly_unknown = true;
  EXPECT_TRUE(inserts(s));
  s.covered = true;
  EXPECT_FALSE(inserts(s)) << "nothing may be learnt where witnesses contradict";
}

TEST(KeyframePolicy, keeps_the_configured_distance) {
  KeyframeSituation s = steady();
  s.inliers = 200;
  KeyframeConfig config;
  config.min_gap_s = 0.25;
  EXPECT_FALSE(wants_keyframe(s, config));
  s.since_keyframe_s = 0.25;
  EXPECT_TRUE(wants_keyframe(s, config));
}

}  // namespace
}  // namespace rtd::slam
