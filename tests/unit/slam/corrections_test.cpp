// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/slam/core/corrections.hpp"

namespace rtd::slam {
namespace {

using ::testing::ElementsAre;
using Kind = KeyframeChange::Kind;

KeyframeChange change(Kind kind, KeyframeId id, double x_m = 0) {
  KeyframeChange change;
  change.kind = kind;
  change.id = id;
  change.T_world_camera.translation().x() = x_m;
  return change;
}

std::vector<KeyframeId> ids(const std::vector<KeyframeChange>& changes) {
  std::vector<KeyframeId> ids;
  for (const KeyframeChange& change : changes) ids.push_back(change.id);
  return ids;
}

TEST(KeyframeChangeQueue, publishes_thousands_of_corrections_in_portions_newest_first_and_loses_none) {
  constexpr KeyframeId kCount = 5000;
  KeyframeChangeQueue queue;
  std::vector<KeyframeChange> all;
  for (KeyframeId id = 0; id < kCount; ++id) all.push_back(change(Kind::kCorrected, id));
  queue.add(all);
  std::vector<KeyframeId> reported;
  while (!queue.empty()) {
    const auto portion = ids(queue.take(48));
    ASSERT_LE(portion.size(), 48U);
    reported.insert(reported.end(), portion.begin(), portion.end());
  }
  ASSERT_EQ(reported.size(), kCount);
  for (KeyframeId i = 0; i < kCount; ++i) ASSERT_EQ(reported[i], kCount - 1 - i);
}

TEST(KeyframeChangeQueue, new_and_removed_keyframes_do_not_wait_behind_corrections) {
  KeyframeChangeQueue queue;
  queue.add({change(Kind::kCorrected, 1), change(Kind::kCorrected, 2), change(Kind::kRemoved, 2)});
  queue.add({change(Kind::kCreated, 3)});
  EXPECT_THAT(ids(queue.take(2)), ElementsAre(2, 3));
  EXPECT_THAT(ids(queue.take(9)), ElementsAre(1)) << "a keyframe that is gone is not reported";
}

TEST(KeyframeChangeQueue, a_keyframe_that_moves_again_is_published_once_with_its_last_pose) {
  KeyframeChangeQueue queue;
  queue.add({change(Kind::kCorrected, 1, 0.5)});
  queue.add({change(Kind::kCorrected, 1, 0.7)});
  const auto reported = queue.take(9);
  ASSERT_EQ(reported.size(), 1U);
  EXPECT_EQ(reported[0].T_world_camera.translation().x(), 0.7);
}

TEST(OdometryFrame, takes_up_a_jump_so_that_the_odometry_stays_where_it_was) {
  OdometryFrame frame{LoopConfig{}};
  const Eigen::Isometry3d before = geometry::se3_exp(geometry::Vector6d::Constant(0.3));
  const Eigen::Isometry3d after = geometry::se3_exp((geometry::Vector6d() << 1, 2, 3, 0, 0.4, 0).finished()) * before;
  const Eigen::Isometry3d T_odom_camera = frame.T_map_odom().inverse() * before;
  EXPECT_TRUE(frame.correct(before, after));
  EXPECT_TRUE((frame.T_map_odom().inverse() * after).isApprox(T_odom_camera, 1e-12));
}

TEST(OdometryFrame, leaves_the_small_steps_of_local_adjustment_in_the_odometry) {
  OdometryFrame frame{LoopConfig{}};
  const Eigen::Isometry3d nearby(Eigen::Translation3d(0.005, 0, 0));
  EXPECT_FALSE(frame.correct(Eigen::Isometry3d::Identity(), nearby));
  EXPECT_TRUE(frame.T_map_odom().matrix().isIdentity(0));
}

}  // namespace
}  // namespace rtd::slam
