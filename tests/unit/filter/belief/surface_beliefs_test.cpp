// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/static_probability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

/// A wall parallel to the image, and what was believed of it.
class SurfaceBeliefsTest : public ::testing::Test {
 protected:
  DepthGrid wall(double depth_m) { return sampler_.sample(test::wall_image(depth_m)); }
  CellBeliefs recall(const DepthGrid& now, const Eigen::Isometry3d& T_last_current = Eigen::Isometry3d::Identity()) {
    return beliefs_.recall(now, sampler_.rays(), camera_, T_last_current);
  }
  const geometry::CameraModel camera_ = test::wall_image().camera;
  DepthGridSampler sampler_ = test::make_sampler();
  SurfaceBeliefs beliefs_;
};

TEST(LogOdds, adds_up_and_returns) {
  EXPECT_FLOAT_EQ(log_odds(0.5), 0);
  EXPECT_NEAR(probability(log_odds(0.1)), 0.1, 1e-6);
  EXPECT_TRUE(std::isfinite(log_odds(0)));
  EXPECT_TRUE(std::isfinite(log_odds(1)));
}

TEST_F(SurfaceBeliefsTest, follow_a_wall_that_the_camera_passes) {
  const DepthGrid at_2_m = wall(2.0);
  CellBeliefs stored(at_2_m.depth_m.size(), -1.0F);
  const int spot = at_2_m.shape.index(80, 60);
  stored[static_cast<std::size_t>(spot)] = 3.0F;
  beliefs_.store(at_2_m, stored);
  Eigen::Isometry3d T_last_current = Eigen::Isometry3d::Identity();
  T_last_current.translation().x() = 2.0 * 5 * kCellPx / camera_.parameters().fx;  // five cells to the right
  const CellBeliefs recalled = recall(at_2_m, T_last_current);
  EXPECT_FLOAT_EQ(recalled[static_cast<std::size_t>(spot - 5)], 3.0F);
  EXPECT_FLOAT_EQ(recalled[static_cast<std::size_t>(spot)], -1.0F);
  EXPECT_FALSE(is_known(recalled[static_cast<std::size_t>(at_2_m.shape.index(158, 60))])) << "was not in view";
}

TEST_F(SurfaceBeliefsTest, are_not_inherited_by_what_steps_in_front) {
  const DepthGrid far = wall(3.0);
  beliefs_.store(far, CellBeliefs(far.depth_m.size(), 4.0F));
  EXPECT_TRUE(is_known(recall(far)[5000]));
  EXPECT_FALSE(is_known(recall(wall(1.5))[5000]));
}

TEST_F(SurfaceBeliefsTest, are_none_before_the_first_frame_and_after_another_camera) {
  const DepthGrid now = wall(2.0);
  EXPECT_FALSE(is_known(recall(now)[0]));
  const DepthGrid small{{2, 2}, std::vector<float>(4, 2.0F), std::vector<float>(4, 2.0F), std::vector<float>(4, 2.0F)};
  beliefs_.store(small, CellBeliefs(4, 1.0F));
  EXPECT_FALSE(is_known(recall(now)[0]));
}

}  // namespace
}  // namespace rtd::filter
