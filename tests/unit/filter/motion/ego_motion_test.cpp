// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/ego_motion.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/se3.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kNowNs = 100'000'000;

/// A camera that has turned and gone on for 0.1 s.
class EgoMotionTest : public ::testing::Test {
 protected:
  /// `count` features in a pixel rectangle, seen then and now; `depth_m` is measured or not.
  void add(int count, const cv::Rect& area, double depth_m, bool measured) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p_then = camera_.unproject({u(random_), v(random_)}, depth_m);
      const Eigen::Vector3d p_now = T_world_camera_.inverse() * p_then;
      msg::Feature feature{};
      for (std::uint8_t& byte : feature.descriptor) byte = static_cast<std::uint8_t>(random_());
      then_.features.push_back(placed(feature, p_then, measured));
      now_.push_back(placed(feature, p_now, measured));
      cluster_of_.push_back(measured ? 0 : -1);
    }
  }
  msg::Feature placed(msg::Feature feature, const Eigen::Vector3d& p_camera, bool measured) {
    std::normal_distribution<double> noise_px(0, 0.4);
    const Eigen::Vector2d pixel = camera_.project(p_camera);
    feature.u_px = static_cast<float>(pixel.x() + noise_px(random_));
    feature.v_px = static_cast<float>(pixel.y() + noise_px(random_));
    feature.depth_m = measured ? static_cast<float>(p_camera.z()) : 0;
    return feature;
  }
  EgoMotion estimate() {
    ViewStore views;
    views.add(then_);
    const vision::FeatureGrid grid(now_, 640, 480);
    const std::vector<char> excluded(now_.size(), 0);
    const DepthClusters clusters{{160, 120}, std::vector<std::int32_t>(160 * 120, 0), {9000}};
    const EgoMotionInput input{{now_, grid, camera_},        excluded, cluster_of_, clusters, views, kNowNs,
                               Eigen::Isometry3d::Identity()};
    return estimate_ego_motion(input, EgoMotionConfig{}, GeometryConfig{});
  }
  double error_m(const EgoMotion& ego) const {
    return (ego.T_world_camera.translation() - T_world_camera_.translation()).norm();
  }

  std::mt19937_64 random_{3};
  const geometry::CameraModel camera_ = test::pinhole();
  const Eigen::Isometry3d T_world_camera_ =
      geometry::se3_exp((geometry::Vector6d() << 0.02, 0, 0.01, 0.002, 0.02, 0.001).finished());
  View then_;
  std::vector<msg::Feature> now_;
  std::vector<int> cluster_of_;
};

TEST_F(EgoMotionTest, a_wall_beyond_the_range_of_depth_shows_how_the_camera_has_turned) {
  add(24, {260, 400, 120, 70}, 2.5, true);   // a piece of the floor: a turn hardly differs from a shift
  add(200, {60, 20, 500, 200}, 6.5, false);  // the wall
  const EgoMotion ego = estimate();
  ASSERT_TRUE(ego.reliable);
  EXPECT_LT(error_m(ego), 0.008);
}

TEST_F(EgoMotionTest, what_has_no_depth_votes_on_no_surface) {
  add(100, {60, 260, 500, 200}, 2.5, true);
  add(100, {60, 20, 500, 200}, 6.5, false);
  const EgoMotion ego = estimate();
  ASSERT_TRUE(ego.reliable);
  EXPECT_LE(ego.votes.shifts.size(), 100U);
}

TEST_F(EgoMotionTest, no_depth_next_to_something_near_is_its_shadow) {
  add(50, {60, 20, 500, 200}, 6.5, false);
  then_.grid.shape = {160, 120};
  const vision::FeatureGrid grid(now_, 640, 480);
  const auto matches = [&](float depth_m) {
    then_.grid.depth_m.assign(160 * 120, depth_m);
    return match_by_projection(then_, {now_, grid, camera_}, Eigen::Isometry3d::Identity(), 30, EgoMotionConfig{}, 0,
                               Unmeasured::kFar)
        .size();
  };
  EXPECT_EQ(matches(1.5F), 0U);
  EXPECT_GE(matches(4), 40U);
  EXPECT_GE(matches(0), 40U);
}

}  // namespace
}  // namespace rtd::filter
