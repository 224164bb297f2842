// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/static_map.hpp"

#include <gmock/gmock.h>

#include <limits>

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

}  // namespace
}  // namespace rtd::dense
