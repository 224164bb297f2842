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

TEST(OdometryStretch, spreads_what_odometry_was_wrong_by_evenly_over_its_frames) {
  OdometryStretch stretch;
  std::vector<Eigen::Isometry3d> poses;
  for (std::uint64_t seq = 10; seq < 13; ++seq) {
    poses.emplace_back(Eigen::Translation3d(0.1 * static_cast<double>(seq), 0, 0) *
                       Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()));
    stretch.add(seq, poses.back());
  }
  Eigen::Isometry3d T_world_expected = poses.back();
  T_world_expected.translation().x() += 0.1;
  Eigen::Isometry3d T_world_found = T_world_expected;
  T_world_found.translation().z() += 0.08;
  T_world_found.linear() = Eigen::AngleAxisd(0.04, Eigen::Vector3d::UnitX()) * T_world_expected.linear();
  const auto corrections = stretch.spread(T_world_expected, T_world_found);
  ASSERT_EQ(corrections.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = static_cast<double>(i + 1) / 4;
    Eigen::Isometry3d T_world_smoothed = poses[i];
    T_world_smoothed.translation().z() += share * 0.08;
    T_world_smoothed.linear() = Eigen::AngleAxisd(share * 0.04, Eigen::Vector3d::UnitX()) * T_world_smoothed.linear();
    EXPECT_EQ(corrections[i].seq, 10 + i);
    EXPECT_TRUE((poses[i] * corrections[i].T_claimed_smoothed).isApprox(T_world_smoothed, 1e-9)) << i;
  }
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
