// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "services/dense/core/static_map.hpp"
#include "services/dense/core/voxel_map.hpp"
#include "tests/unit/dense/wall_scene.hpp"

namespace rtd::dense {
namespace {

using test::at_origin;
using test::keyframe;
using test::WallScene;
using Outcome = FusionReport::Outcome;

const cv::Rect kPerson{60, 30, 40, 80}, kNoPerson{};

/// Believed points nearer than half way to the wall.
std::size_t ghosts(StaticMap& map) {
  const auto cloud = map.cloud();
  return static_cast<std::size_t>(
      std::count_if(cloud.begin(), cloud.end(), [](const CloudPoint& point) { return point.p_world.z() < 2.2F; }));
}

class StaticMapTest : public testing::Test {
 protected:
  WallScene scene;
  StaticMap map{WallScene::config()};
};

TEST_F(StaticMapTest, fuses_a_noisy_wall_to_less_than_the_noise) {
  for (int i = 0; i < 30; ++i)
    ASSERT_EQ(map.integrate(scene.render(), all_static(), at_origin()).outcome, Outcome::kFused);
  double error_m = 0, weight = 0;
  for (const CloudPoint& point : map.cloud()) {
    error_m += static_cast<double>(point.weight) * std::abs(static_cast<double>(point.p_world.z()) - WallScene::kWallM);
    weight += static_cast<double>(point.weight);
  }
  const double noise_m = geometry::DepthNoise{}.sigma_m(WallScene::kWallM);
  EXPECT_LT(error_m / weight, 0.4 * noise_m) << "m; one reading: " << 0.8 * noise_m;
}

TEST_F(StaticMapTest, leaves_out_a_person_under_the_mask_from_the_first_frame_on) {
  for (int i = 0; i < 10; ++i) {
    const FusionReport report = map.integrate(scene.render(kPerson), WallScene::mask(kPerson), at_origin());
    EXPECT_GT(report.masked, 1000U);
  }
  EXPECT_EQ(ghosts(map), 0U);
  EXPECT_GT(map.cloud().size(), 5000U) << "the wall beside the person";
}

TEST(StaticMap, has_a_ghost_of_a_person_without_mask_until_it_is_seen_through) {
  WallScene scene;
  const DenseConfig config = WallScene::config();
  StaticMap map(config);
  for (int i = 0; i < 40; ++i) map.integrate(scene.render(kPerson), all_static(), at_origin());
  EXPECT_GT(ghosts(map), 500U);
  const int needed = config.carving.max_evidence + config.carving.frames;
  for (int i = 0; i < needed; ++i) map.integrate(scene.render(kNoPerson), all_static(), at_origin());
  EXPECT_LT(ghosts(map), 10U) << "after " << needed << " frames";
}

TEST_F(StaticMapTest, carves_at_pixels_of_moving_objects_too) {
  for (int i = 0; i < 5; ++i) map.integrate(scene.render(kPerson), all_static(), at_origin());
  const DynamicMask all_dynamic{1, 1, {DynamicMask::kDynamic}};
  for (int i = 0; i < 8; ++i) map.integrate(scene.render(kNoPerson), all_dynamic, at_origin());
  EXPECT_LT(ghosts(map), 10U);
}

TEST(StaticMap, does_not_carve_a_static_wall) {
  WallScene scene(1.5);
  StaticMap map(WallScene::config());
  std::uint64_t carved = 0;
  for (int i = 0; i < 60; ++i) carved += map.integrate(scene.render(), all_static(), at_origin()).carved;
  EXPECT_LT(carved, map.voxels() / 100);
}

TEST(StaticMap, does_not_fuse_unknown_cells_unless_configured) {
  WallScene scene;
  const DynamicMask unknown{1, 1, {DynamicMask::kUnknown}};
  StaticMap map(WallScene::config());
  EXPECT_EQ(map.integrate(scene.render(), unknown, at_origin()).fused, 0U);
  DenseConfig config = WallScene::config();
  config.fusion.unknown_is_static = true;
  StaticMap bold(config);
  EXPECT_GT(bold.integrate(scene.render(), unknown, at_origin()).fused, 10'000U);
}

TEST(StaticMap, stays_within_its_memory_and_counts_what_it_refused) {
  WallScene scene;
  DenseConfig config = WallScene::config();
  config.fusion.max_voxels = 2000;
  StaticMap map(config);
  FusionReport report;
  for (int i = 0; i < 3; ++i) report = map.integrate(scene.render(), all_static(), at_origin());
  EXPECT_EQ(map.voxels(), 2000U);
  EXPECT_TRUE(map.full());
  EXPECT_GT(report.refused, 1000U);
}

TEST_F(StaticMapTest, refuses_poses_and_images_that_make_no_sense) {
  Eigen::Isometry3d no_pose = at_origin();
  no_pose.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(map.integrate(scene.render(), all_static(), no_pose).outcome, Outcome::kBadPose);
  vision::RgbdImage other_size = scene.render();
  other_size.depth = other_size.depth(cv::Rect(0, 0, 80, 60)).clone();
  EXPECT_EQ(map.integrate(other_size, all_static(), at_origin()).outcome, Outcome::kBadImage);
  EXPECT_EQ(map.integrate(scene.render(), DynamicMask{40, 30, {}}, at_origin()).outcome, Outcome::kBadImage);
  EXPECT_EQ(map.voxels(), 0U);
}

TEST_F(StaticMapTest, takes_depth_of_nothing_and_of_everything) {
  for (const int raw : {0, 1, 65535}) {
    vision::RgbdImage image = scene.render();
    image.depth.setTo(raw);
    const FusionReport report = map.integrate(image, all_static(), at_origin());
    EXPECT_EQ(report.outcome, Outcome::kFused);
    EXPECT_EQ(report.fused, 0U) << raw;
  }
}

TEST_F(StaticMapTest, follows_another_calibration_and_image_size) {
  map.integrate(scene.render(), all_static(), at_origin());
  vision::RgbdImage half = scene.render();
  cv::Mat depth(60, 80, CV_16UC1, cv::Scalar(15000)), color(60, 80, CV_8UC3, cv::Scalar(1, 2, 3));
  half.depth = depth;
  half.color_bgr = color;
  half.camera = geometry::CameraModel({65.5, 65.5, 39.5, 29.5, {0.1, 0, 0, 0, 0}, 80, 60});
  const FusionReport report = map.integrate(half, all_static(), at_origin());
  EXPECT_EQ(report.outcome, Outcome::kFused);
  EXPECT_GT(report.fused, 3000U);
}

TEST_F(StaticMapTest, moves_with_the_keyframes_that_slam_corrects) {
  map.update(keyframe(0, 0));
  for (int i = 0; i < 3; ++i) map.integrate(scene.render(kPerson), all_static(), at_origin());
  const auto left_edge_m = [this] {
    float left_m = 100;
    for (const CloudPoint& point : map.cloud()) {
      if (point.p_world.z() < 2.2F) left_m = std::min(left_m, point.p_world.x());
    }
    return left_m;
  };
  const float before_m = left_edge_m();
  map.update(keyframe(1, 0));
  map.update(keyframe(0, 0.25, msg::KeyframeEventKind::kCorrected));
  EXPECT_NEAR(left_edge_m(), before_m + 0.25F, 0.015) << "m";
  map.update(keyframe(0, 0, msg::KeyframeEventKind::kRemoved));  // keyframe 1 takes over
  map.update(keyframe(1, 0.5, msg::KeyframeEventKind::kCorrected));
  EXPECT_NEAR(left_edge_m(), before_m + 0.75F, 0.03) << "m";
}

TEST_F(StaticMapTest, gives_no_more_points_than_requested) {
  for (int i = 0; i < 3; ++i) map.integrate(scene.render(), all_static(), at_origin());
  const std::size_t all = map.cloud().size();
  const auto few = map.cloud(500);
  EXPECT_GT(all, 5000U);
  EXPECT_LE(few.size(), 500U);
  EXPECT_GT(few.size(), 100U);
}

const Eigen::Vector3f kAhead = Eigen::Vector3f::UnitZ();

Sample sample(const Eigen::Vector3f& p_world, float gate_m = 0, float weight = 1) {
  return {p_world, kAhead, gate_m, weight, {10, 20, 30}};
}

TEST(VoxelMap, keeps_the_weighted_mean_of_a_cell) {
  VoxelMap map({});
  ASSERT_TRUE(map.add(sample({0.001F, 0.001F, 1.001F}, 0, 1), 1, 0));
  ASSERT_TRUE(map.add({{0.005F, 0.001F, 1.001F}, kAhead, 0, 3, {50, 20, 30}}, 2, 0));
  ASSERT_EQ(map.voxels().size(), 1U);
  const Voxel& voxel = map.voxels()[0];
  EXPECT_NEAR(voxel.p_world.x(), 0.004, 1e-6) << "m";
  EXPECT_NEAR(voxel.bgr[0], 40, 1e-4);
  EXPECT_FLOAT_EQ(voxel.weight, 4);
  EXPECT_EQ(voxel.sightings, 2);
}

TEST(VoxelMap, counts_a_frame_once) {
  VoxelMap map({});
  for (int i = 0; i < 5; ++i) map.add(sample({0, 0, 1}), 7, 0);
  EXPECT_EQ(map.voxels()[0].sightings, 1);
  EXPECT_EQ(map.voxels()[0].evidence, 1);
}

TEST(VoxelMap, joins_the_surface_along_the_ray_but_nothing_behind_the_gate) {
  VoxelMap map({});
  map.add(sample({0.001F, 0.001F, 1.001F}, 0, 10), 1, 0);
  map.add(sample({0.001F, 0.001F, 1.031F}, 0.04F), 2, 0);
  EXPECT_EQ(map.voxels().size(), 1U) << "3 cm behind, the gate is 4 cm";
  map.add(sample({0.001F, 0.001F, 1.051F}, 0.04F), 3, 0);
  EXPECT_EQ(map.voxels().size(), 2U) << "5 cm behind";
}

TEST(VoxelMap, refuses_new_voxels_when_full_and_refines_known_ones) {
  VoxelMap map({.max_voxels = 10});
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(map.add(sample({0.1F * static_cast<float>(i), 0, 1}), 1, 0), i < 10) << i;
  }
  EXPECT_TRUE(map.full());
  EXPECT_TRUE(map.add(sample({0, 0, 1}), 2, 0));
  EXPECT_EQ(map.voxels().size(), 10U);
}

TEST(VoxelMap, refuses_points_that_are_not_finite_or_out_of_bounds) {
  VoxelMap map({});
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(kNan, 0, 0), Eigen::Vector3f(0, kInf, 0), Eigen::Vector3f(0, 0, 1e9F)}) {
    EXPECT_FALSE(map.add(sample(p), 1, 0));
    EXPECT_EQ(map.at(p), nullptr);
  }
}

TEST(VoxelMap, finds_every_voxel_after_some_were_taken_away) {
  VoxelMap map({});
  for (int i = 0; i < 100; ++i) map.add(sample({0.1F * static_cast<float>(i), 0, 1}), 1, static_cast<AnchorId>(i % 2));
  EXPECT_EQ(map.remove_if([](Voxel& voxel) { return voxel.anchor == 1; }), 50U);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(map.at({0.1F * static_cast<float>(i), 0, 1}) != nullptr, i % 2 == 0) << i;
  }
}

TEST(VoxelMap, moves_the_points_of_an_anchor_and_merges_those_that_meet) {
  VoxelMap map({});
  map.add(sample({0.005F, 0, 1.005F}, 0, 1), 1, 0);
  map.add(sample({0.505F, 0, 1.005F}, 0, 3), 2, 1);
  map.add(sample({1.005F, 0, 1.005F}, 0, 1), 3, 2);
  Eigen::Isometry3f left = Eigen::Isometry3f::Identity();
  left.translation().x() = -0.5F;
  const std::map<AnchorId, Eigen::Isometry3f> motions{{1, left}, {2, left}};
  map.move([&](AnchorId anchor) {
    const auto found = motions.find(anchor);
    return found == motions.end() ? nullptr : &found->second;
  });
  ASSERT_EQ(map.voxels().size(), 2U) << "the second joined the first; the third took the second's place untouched";
  ASSERT_NE(map.at({0.005F, 0, 1.005F}), nullptr);
  EXPECT_FLOAT_EQ(map.at({0.005F, 0, 1.005F})->weight, 4);
  ASSERT_NE(map.at({0.505F, 0, 1.005F}), nullptr);
  EXPECT_EQ(map.at({0.505F, 0, 1.005F})->anchor, 2U);
  EXPECT_EQ(map.at({1.005F, 0, 1.005F}), nullptr);
}

}  // namespace
}  // namespace rtd::dense
