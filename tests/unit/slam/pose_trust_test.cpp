// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include "services/slam/slam_messages.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;

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
