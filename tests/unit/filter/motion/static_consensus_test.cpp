// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/static_consensus.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/se3.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

/// Points of a room in front of the camera and of a mover, seen from a camera that has moved.
class StaticConsensusTest : public ::testing::Test {
 protected:
  /// `count` points in a pixel rectangle at a depth, displaced by `moved_m` since the reference.
  void add(int count, const cv::Rect& area, double depth_m, int cluster,
           const Eigen::Vector3d& moved_m = Eigen::Vector3d::Zero()) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height);
    std::normal_distribution<double> noise_px(0, 0.5);
    for (int i = 0; i < count; ++i) {
      PointSighting s;
      s.pixel = {u(random_), v(random_)};
      s.depth_m = depth_m;
      s.p_world = T_world_camera_ * camera_.unproject(s.pixel, depth_m) - moved_m;
      s.pixel += Eigen::Vector2d(noise_px(random_), noise_px(random_));
      s.sigma_px = 1;
      s.cluster = cluster;
      sightings_.push_back(s);
    }
  }
  double error_m(const StaticConsensus& found) const {
    return (T_world_camera_.inverse() * found.T_world_camera).translation().norm();
  }
  StaticConsensus find() const {
    return find_static_consensus(sightings_, camera_, Eigen::Isometry3d::Identity(), EgoMotionConfig{});
  }
  std::mt19937_64 random_{5};
  geometry::CameraModel camera_ = test::pinhole();
  Eigen::Isometry3d T_world_camera_ =
      geometry::se3_exp((geometry::Vector6d() << 0.02, -0.01, 0.015, 0.004, -0.006, 0.003).finished());
  std::vector<PointSighting> sightings_;
};

TEST_F(StaticConsensusTest, finds_the_motion_in_a_static_room) {
  add(100, {0, 0, 640, 240}, 3.0, 0);
  add(100, {0, 240, 640, 240}, 2.0, 1);
  const StaticConsensus found = find();
  EXPECT_LT(error_m(found), 0.004) << "m";
  EXPECT_GT(found.image_share, 0.8);
}

TEST_F(StaticConsensusTest, follows_the_walls_although_the_mover_carries_more_features) {
  add(60, {0, 0, 640, 160}, 3.5, 0);
  add(60, {0, 400, 640, 80}, 2.5, 1);
  add(200, {220, 160, 160, 240}, 1.2, 2, {0.05, 0, 0});
  const StaticConsensus found = find();
  EXPECT_LT(error_m(found), 0.02) << "m, the mover went 0.05 m";
}

TEST_F(StaticConsensusTest, has_no_share_without_sightings) {
  EXPECT_EQ(find().image_share, 0);
}

TEST_F(StaticConsensusTest, survives_points_behind_the_camera_and_without_depth) {
  add(100, {0, 0, 640, 480}, 2.0, 0);
  for (std::size_t i = 0; i < 20; ++i) sightings_[i].p_world.z() = -2;
  for (std::size_t i = 20; i < 40; ++i) sightings_[i].depth_m = 0;
  EXPECT_LT(error_m(find()), 0.01) << "m";
}

TEST_F(StaticConsensusTest, lets_the_features_of_a_mover_vote_against_it) {
  add(100, {0, 0, 640, 160}, 3.5, 0);
  add(40, {220, 160, 160, 240}, 1.2, 1, {0.05, 0, 0});
  DepthClusters clusters{{160, 120}, std::vector<std::int32_t>(160 * 120, 0), {100, 100}};
  const FeatureVotes votes = count_votes(sightings_, camera_, T_world_camera_, clusters);
  EXPECT_FALSE(votes.cluster_moves(0, GeometryConfig{}));
  EXPECT_TRUE(votes.cluster_moves(1, GeometryConfig{}));
  EXPECT_FALSE(votes.cluster_moves(99, GeometryConfig{})) << "a cluster without votes";
}

}  // namespace
}  // namespace rtd::filter
