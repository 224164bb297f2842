// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A camera that is carried away with its eyes shut begins a map of its own; when it walks back, the two become one.
#include <gtest/gtest.h>

#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/support/two_places.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
constexpr double kStep_m = 0.05, kFarEnd_m = -3;

class TwoPlaces : public ::testing::Test {
 protected:
  FrameResult look_from(double x_m) {
    T_world_camera_.translation().x() = x_m;
    return show(*places_.view(next_, T_world_camera_));
  }
  FrameResult look_at_nothing() { return show(*test_support::make_empty_view(next_)); }
  FrameResult show(const msg::FeatureFrame& frame) {
    ++next_;
    return slam_.process(frame).result;
  }
  double error_m(const FrameResult& result) const {
    return (result.T_world_camera.translation() - T_world_camera_.translation()).norm();
  }

 private:
  test_support::TwoPlaces places_;
  SlamSystem slam_{test_support::settled(), MappingMode::kSynchronous, [] { return std::int64_t{0}; }};
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();
  std::uint64_t next_ = 0;
};

TEST_F(TwoPlaces, become_one_map_when_the_lost_camera_walks_back) {
  double x_m = 0;
  const auto walk_to = [&](double end_m, std::uint32_t while_maps) {
    const double step_m = end_m > x_m ? kStep_m : -kStep_m;
    FrameResult result;
    for (result.maps = while_maps; std::abs(end_m - x_m) > kStep_m / 2 && result.maps == while_maps; x_m += step_m) {
      result = look_from(x_m);
      EXPECT_EQ(result.state, TrackingState::kOk) << "at " << x_m << " m";
    }
    return result;
  };
  walk_to(1.5, 1);
  walk_to(kFarEnd_m, 1);
  for (int i = 0; i < 60; ++i) ASSERT_NE(look_at_nothing().state, TrackingState::kOk);

  x_m = test_support::TwoPlaces::kHallX_m + 2;  // nothing of the desk is seen from here
  FrameResult result;
  for (int i = 0; i < 120 && result.state != TrackingState::kOk; ++i) result = look_from(x_m);
  ASSERT_EQ(result.state, TrackingState::kOk) << "no new map in four seconds";
  EXPECT_EQ(result.map_id, 1U);
  EXPECT_EQ(result.maps, 2U);

  result = walk_to(kFarEnd_m, 2);
  ASSERT_EQ(result.maps, 1U);
  result = look_from(x_m);
  ASSERT_EQ(result.state, TrackingState::kOk);
  EXPECT_EQ(result.map_id, 0U);
  EXPECT_LT(error_m(result), 0.02) << "in the world of the first map";
}

}  // namespace
}  // namespace rtd::slam
