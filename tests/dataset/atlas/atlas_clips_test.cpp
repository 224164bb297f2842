// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/atlas_trial.hpp"
#include "tests/support/clip_uri.hpp"

namespace rtd::test_support {
namespace {

OfflineOptions with_true_masks() {
  OfflineOptions options;
  options.front_end.mode = "true-mask";
  return options;
}

/// Two walks through one room, with the people of each left out by the true masks.
TEST(AtlasClips, two_robots_in_one_room_are_in_one_map) {
  const std::string source = clip_uri("walk_xyz", "?masks=1");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no walk_xyz";
  constexpr double kJointAte_m = 0.0026, kFirstPose_m = 0.002;  // docs/results.md
  constexpr double kSlack = 1.3;
  const TrialResult result = run_atlas_trial({{"anna", source, 0, 105}, {"bert", source, 105, 105}}, with_true_masks());
  EXPECT_TRUE(result.robots[1].met);
  EXPECT_GE(result.counters.meetings, 1U);
  EXPECT_LE(result.ate_joint_m, kSlack * kJointAte_m);
  EXPECT_EQ(result.robots[1].first_pose_s, 0) << "recognised with the first frame that asks";
  EXPECT_LE(result.robots[1].first_pose_error_m, kSlack * kFirstPose_m);
}

/// The same furniture, posters out of the same pile, the same three people: four rooms all the same.
TEST(AtlasClips, rooms_that_look_alike_are_not_taken_for_one) {
  std::vector<TrialRobot> robots;
  for (const char* clip : {"walk_xyz", "walk_rpy", "kinect_half", "kinect_rpy"}) {
    const std::string source = clip_uri(clip, "?masks=1");
    if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << clip;
    robots.push_back({clip, source, 0, 100});
  }
  const TrialResult result = run_atlas_trial(robots, with_true_masks());
  EXPECT_EQ(result.counters.meetings, 0U);
  for (std::size_t i = 1; i < robots.size(); ++i) EXPECT_FALSE(result.robots[i].met) << robots[i].name;
}

/// Sides of a corridor that are the same to the last pixel: only the way walked distinguishes them.
TEST(AtlasClips, sides_of_a_corridor_that_are_the_same_join_no_robots) {
  OfflineOptions options;
  options.front_end.mode = "off";
  const std::string corridor = "synthetic:lookalike?seed=1";
  const TrialResult result = run_atlas_trial({{"anna", corridor, 0, 60}, {"bert", corridor, 70, 110}}, options);
  EXPECT_GT(result.counters.met, 20U) << "keyframes of bert are found where anna was";
  EXPECT_EQ(result.counters.meetings, result.counters.refused) << "all taken back";
  EXPECT_FALSE(result.robots[1].met);
}

}  // namespace
}  // namespace rtd::test_support
