// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/slam/core/corrections.hpp"
#include "services/slam/slam_messages.hpp"

namespace rtd::slam {
namespace {

using ::testing::ElementsAre;
using Kind = KeyframeChange::Kind;
using msg::TrackingState;

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

msg::TrackingResult result_in(TrackingState state, std::uint32_t features_static, std::uint32_t features_removed) {
  FrameResult result;
  result.state = state;
  result.features_static = features_static;
  result.features_removed = features_removed;
  result.covariance = 1e-4 * geometry::Matrix6d::Identity();
  return make_result(result);
}

ViewState view_of(TrackingState state, std::uint32_t features_static, std::uint32_t features_removed) {
  return TrustMonitor().add(result_in(state, features_static, features_removed), 1).view;
}

TEST(PoseTrust, people_who_fill_the_view_are_a_crowd_in_every_state) {
  for (const TrackingState state : {TrackingState::kOk, TrackingState::kPredicted, TrackingState::kLost})
    EXPECT_EQ(view_of(state, 500, 500), ViewState::kCrowded);
  EXPECT_EQ(view_of(TrackingState::kOk, 501, 499), ViewState::kClear);
}

TEST(PoseTrust, a_camera_that_sees_well_but_is_not_located_is_lost) {
  EXPECT_EQ(view_of(TrackingState::kLost, 900, 100), ViewState::kUnknown);
  EXPECT_EQ(view_of(TrackingState::kRelocalizing, 900, 100), ViewState::kUnknown);
}

TEST(PoseTrust, a_dark_or_covered_camera_is_blind) {
  EXPECT_EQ(view_of(TrackingState::kLost, 60, 39), ViewState::kBlind);
  EXPECT_EQ(view_of(TrackingState::kLost, 61, 39), ViewState::kUnknown);
  EXPECT_EQ(view_of(TrackingState::kOk, 60, 0), ViewState::kClear);  // a bare wall that suffices
}

TEST(PoseTrust, doubt_without_a_crowd_is_a_contradiction) {
  EXPECT_EQ(view_of(TrackingState::kDoubtful, 900, 100), ViewState::kContradicted);
  EXPECT_STREQ(to_string(ViewState::kContradicted), "contradicted");
}

TEST(PoseTrust, one_frame_makes_no_crowd) {
  TrustMonitor monitor;
  const auto add = [&monitor](std::int64_t stamp_ns, std::uint32_t removed) {
    msg::TrackingResult result = result_in(TrackingState::kOk, 1000 - removed, removed);
    result.stamp_ns = stamp_ns;
    return monitor.add(result, 1);
  };
  EXPECT_NEAR(add(0, 100).view_removed, 0.1, 1e-9);
  EXPECT_EQ(add(33'000'000, 900).view, ViewState::kClear);
  EXPECT_EQ(add(1'033'000'000, 900).view, ViewState::kCrowded);
}

TEST(PoseTrust, time_since_ok_grows_until_ok_returns) {
  TrustMonitor monitor;
  const auto since = [&monitor](TrackingState state, std::int64_t stamp_ns) {
    msg::TrackingResult result = result_in(state, 900, 0);
    result.stamp_ns = stamp_ns;
    return monitor.add(result, 1).since_ok_s;
  };
  EXPECT_EQ(since(TrackingState::kInitializing, 5'000'000'000), 0);
  EXPECT_EQ(since(TrackingState::kInitializing, 5'500'000'000), 0.5);
  EXPECT_EQ(since(TrackingState::kOk, 6'000'000'000), 0);
  EXPECT_EQ(since(TrackingState::kDoubtful, 6'250'000'000), 0.25);
  EXPECT_EQ(since(TrackingState::kLost, 8'000'000'000), 2);
  EXPECT_EQ(since(TrackingState::kOk, 8'100'000'000), 0);
}

TEST(PoseTrust, sigmas_are_those_of_the_worst_axis) {
  msg::TrackingResult result = result_in(TrackingState::kOk, 900, 100);
  result.covariance[7] = 0.04;     // y
  result.covariance[35] = 0.0025;  // about z
  const PoseTrust trust = TrustMonitor().add(result, 0.7);
  EXPECT_NEAR(trust.position_sigma_m, 0.2, 1e-9);
  EXPECT_NEAR(trust.rotation_sigma_deg, 2.865, 1e-3);
  EXPECT_EQ(trust.agreement, 0.7);
  EXPECT_NEAR(trust.view_removed, 0.1, 1e-12);
}

TEST(PoseTrust, without_a_pose_nothing_is_known_of_it) {
  const PoseTrust trust = TrustMonitor().add(result_in(TrackingState::kLost, 900, 100), 0);
  EXPECT_EQ(trust.position_sigma_m, 1000);
  EXPECT_EQ(trust.rotation_sigma_deg, 180);
}

}  // namespace
}  // namespace rtd::slam
