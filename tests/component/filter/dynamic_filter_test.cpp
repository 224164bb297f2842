// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/dynamic_filter.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;
using test::removed_share;

constexpr double kNoBlock = 100;
constexpr double kCameraStepM = 0.008, kBlockStepM = 0.03;  // per frame: 0.24 and 0.9 m/s

DynamicFilter make_filter(FilterMode mode) {
  FilterConfig config;
  config.mode = mode;
  return DynamicFilter(config, [] { return std::int64_t{0}; });
}

class DynamicFilterTest : public testing::Test {
 protected:
  const MovingScene scene;
};

TEST_F(DynamicFilterTest, finds_the_pose_of_a_moving_camera_in_a_static_scene) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  FilterResult result;
  for (std::uint64_t i = 0; i < 12; ++i) {
    result = filter.apply(scene.render(i, kCameraStepM * static_cast<double>(i), 0.0), std::nullopt);
    EXPECT_EQ(result.removed, 0U) << "frame " << i;
  }
  EXPECT_TRUE(result.pose_reliable);
  EXPECT_NEAR(result.T_world_camera.translation().x(), 11 * kCameraStepM, 0.006) << "m";
  EXPECT_NEAR(result.T_world_camera.translation().y(), 0, 0.006) << "m";
}

TEST_F(DynamicFilterTest, removes_a_mover_without_a_class_and_keeps_the_room) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  for (std::uint64_t i = 0; i < 15; ++i) {
    const double camera_x = kCameraStepM * static_cast<double>(i),
                 block_x = -0.25 + kBlockStepM * static_cast<double>(i);
    const FilterResult result = filter.apply(scene.render(i, camera_x, block_x), std::nullopt);
    if (i < 5) continue;
    const cv::Rect block = MovingScene::block(camera_x, block_x);
    EXPECT_GE(removed_share(result, block, true), 0.95) << "frame " << i;
    EXPECT_LE(removed_share(result, block, false), 0.05) << "frame " << i;
    EXPECT_NEAR(result.T_world_camera.translation().x(), camera_x, 0.01) << "m, frame " << i;
  }
}

TEST_F(DynamicFilterTest, removes_a_mover_at_three_centimetres_per_second) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  for (std::uint64_t i = 0; i < 115; ++i) {
    const double camera_x = 0.003 * static_cast<double>(i), block_x = 0.001 * static_cast<double>(i);
    const FilterResult result = filter.apply(scene.render(i, camera_x, block_x), std::nullopt);
    const cv::Rect block = MovingScene::block(camera_x, block_x);
    EXPECT_LE(removed_share(result, block, false), 0.05) << "frame " << i;
    const bool at_start = i > 4 && i < 14;  // two poses are compared
    if (!at_start && i < 108) continue;     // later by its displacement over 1.5 s
    EXPECT_GE(removed_share(result, block, true), 0.9) << "frame " << i;
  }
}

TEST_F(DynamicFilterTest, is_not_carried_along_in_the_second_frame) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  filter.apply(scene.render(0, 0, -0.1), std::nullopt);
  const FilterResult result = filter.apply(scene.render(1, kCameraStepM, -0.1 + kBlockStepM), std::nullopt);
  EXPECT_NEAR(result.T_world_camera.translation().x(), kCameraStepM, 0.006) << "m";
  const cv::Rect block = MovingScene::block(kCameraStepM, -0.1 + kBlockStepM);
  for (const msg::Feature& feature : result.features) {
    if (!block.contains(cv::Point(static_cast<int>(feature.u_px), static_cast<int>(feature.v_px)))) continue;
    EXPECT_NE(feature.flags & (msg::kFeatureRemoved | msg::kFeatureInQuestion), 0);
  }
}

TEST_F(DynamicFilterTest, still_removes_a_mover_that_pauses_for_half_a_second) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  for (std::uint64_t i = 0; i < 25; ++i) {
    const double block_x = -0.25 + kBlockStepM * static_cast<double>(std::min<std::uint64_t>(i, 10));
    const FilterResult result = filter.apply(scene.render(i, 0, block_x), std::nullopt);
    if (i < 5) continue;
    EXPECT_GE(removed_share(result, MovingScene::block(0, block_x), true), 0.9) << "frame " << i;
  }
}

TEST_F(DynamicFilterTest, accepts_a_block_that_was_put_down_for_good) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  FilterResult result;
  for (std::uint64_t i = 0; i < 110; ++i) {
    result = filter.apply(scene.render(i, 0, -0.25 + kBlockStepM * static_cast<double>(std::min<std::uint64_t>(i, 10))),
                          std::nullopt);
  }
  EXPECT_EQ(result.removed, 0U) << "three seconds later";
}

TEST_F(DynamicFilterTest, removes_a_person_from_the_first_frame_on) {
  DynamicFilter filter = make_filter(FilterMode::kRtd);
  const cv::Rect block = MovingScene::block(0, 0);
  const std::vector<vision::Detection> boxes{
      {"person", 0.9F, static_cast<float>(block.x - 10), static_cast<float>(block.y - 10), 160, 240}};
  const FilterResult result = filter.apply(scene.render(0, 0, 0), boxes);
  ASSERT_EQ(result.objects.size(), 1U);
  EXPECT_EQ(removed_share(result, block, true), 1.0);
  EXPECT_EQ(removed_share(result, block, false), 0.0);
}

TEST_F(DynamicFilterTest, changes_its_mode_while_it_runs_and_starts_again_in_each) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry), fresh = make_filter(FilterMode::kGeometry);
  const auto frame = [&](std::uint64_t i) {
    return scene.render(i, kCameraStepM * static_cast<double>(i), -0.25 + kBlockStepM * static_cast<double>(i));
  };
  FilterResult result;
  for (std::uint64_t i = 0; i < 8; ++i) result = filter.apply(frame(i), std::nullopt);
  EXPECT_GT(result.removed, 0U);
  filter.set_mode(FilterMode::kOff);
  EXPECT_EQ(filter.mode(), FilterMode::kOff);
  for (std::uint64_t i = 8; i < 10; ++i) EXPECT_EQ(filter.apply(frame(i), std::nullopt).removed, 0U);
  filter.set_mode(FilterMode::kGeometry);
  for (std::uint64_t i = 10; i < 18; ++i) {
    result = filter.apply(frame(i), std::nullopt);
    const FilterResult expected = fresh.apply(frame(i), std::nullopt);
    ASSERT_EQ(result.removed, expected.removed) << "frame " << i;
    ASSERT_EQ(result.T_world_camera.matrix(), expected.T_world_camera.matrix()) << "frame " << i;
  }
  EXPECT_GT(result.removed, 0U);
}

TEST_F(DynamicFilterTest, ignores_boxes_in_geometry_mode_and_everything_in_mode_off) {
  const std::vector<vision::Detection> boxes{{"person", 0.9F, 0, 0, 640, 480}};
  for (const FilterMode mode : {FilterMode::kGeometry, FilterMode::kOff}) {
    EXPECT_EQ(make_filter(mode).apply(scene.render(0, 0, 0), boxes).removed, 0U);
  }
}

TEST_F(DynamicFilterTest, marks_each_cell_as_moving_static_or_unknown) {
  DynamicFilter filter = make_filter(FilterMode::kRtd);
  const cv::Rect block = MovingScene::block(0, 0);
  const std::vector<vision::Detection> boxes{
      {"person", 0.9F, static_cast<float>(block.x - 10), static_cast<float>(block.y - 10), 160, 240}};
  FilterResult result = filter.apply(scene.render(0, 0, 0), boxes);
  const auto at = [&](int x_px, int y_px) {
    return result.motion.at(static_cast<std::size_t>(result.cells.cell_at(x_px, y_px)));
  };
  EXPECT_EQ(at(block.x + 2, block.y + 2), CellMotion::kDynamic);
  EXPECT_EQ(at(block.x - 40, block.y), CellMotion::kUnknown) << "nothing to compare the first frame with";
  for (std::uint64_t i = 1; i < 4; ++i) result = filter.apply(scene.render(i, 0, 0), boxes);
  EXPECT_EQ(at(block.x + 2, block.y + 2), CellMotion::kDynamic);
  EXPECT_EQ(at(block.x - 40, block.y), CellMotion::kStatic);
  EXPECT_TRUE(make_filter(FilterMode::kOff).apply(scene.render(0, 0, 0), boxes).motion.empty());
}

TEST_F(DynamicFilterTest, extracts_more_features_while_something_is_masked) {
  DynamicFilter filter = make_filter(FilterMode::kRtd);
  const std::vector<vision::Detection> person{{"person", 0.9F, 240, 110, 160, 240}}, none;
  filter.apply(scene.render(0, 0, 0), person);
  const std::size_t with = filter.apply(scene.render(1, 0, 0), none).features.size();
  for (std::uint64_t i = 2; i < 12; ++i) filter.apply(scene.render(i, 0, 0), none);  // a third of a second
  const std::size_t without = filter.apply(scene.render(12, 0, 0), none).features.size();
  EXPECT_NEAR(static_cast<double>(with) / static_cast<double>(without), 1.5, 0.05);
}

TEST_F(DynamicFilterTest, makes_no_statement_without_depth) {
  DynamicFilter filter = make_filter(FilterMode::kRtd);
  for (std::uint64_t i = 0; i < 5; ++i) {
    vision::RgbdImage image = scene.render(i, 0, 0.05 * static_cast<double>(i));
    image.depth.setTo(0);
    const FilterResult result = filter.apply(image, std::vector<vision::Detection>{});
    EXPECT_EQ(result.removed, 0U);
    EXPECT_FALSE(result.pose_reliable);
    EXPECT_GT(result.features.size(), 500U);
  }
}

TEST_F(DynamicFilterTest, survives_broken_images_between_good_ones) {
  DynamicFilter filter = make_filter(FilterMode::kRtd);
  const std::vector<vision::Detection> none;
  for (std::uint64_t i = 0; i < 4; ++i) filter.apply(scene.render(i, 0, kNoBlock), none);
  vision::RgbdImage black = scene.render(4, 0, kNoBlock), saturated = scene.render(5, 0, kNoBlock);
  black.color_bgr.setTo(0);
  saturated.depth.setTo(65535);
  EXPECT_TRUE(filter.apply(black, none).features.empty());
  EXPECT_FALSE(filter.apply(saturated, none).features.empty());
  FilterResult result;
  for (std::uint64_t i = 6; i < 10; ++i) result = filter.apply(scene.render(i, 0, kNoBlock), none);
  EXPECT_TRUE(result.pose_reliable);
  EXPECT_EQ(result.removed, 0U);
}

TEST_F(DynamicFilterTest, accepts_stamps_that_stand_still_or_go_backwards) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  for (const std::int64_t stamp_ns : {100, 100, 50, -1'000'000'000, 7'200'000}) {
    vision::RgbdImage image = scene.render(0, 0, 0);
    image.stamp_ns = stamp_ns;
    EXPECT_EQ(filter.apply(image, std::nullopt).removed, 0U);
  }
}

TEST_F(DynamicFilterTest, follows_slam_into_its_world) {
  DynamicFilter filter = make_filter(FilterMode::kGeometry);
  FilterResult result;
  for (std::uint64_t i = 0; i < 6; ++i) result = filter.apply(scene.render(i, 0, 0), std::nullopt);
  EXPECT_NEAR(result.T_world_camera.translation().norm(), 0, 0.002) << "m";
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  T_world_camera.translation() = Eigen::Vector3d(4, 5, 6);
  filter.on_pose({.seq = 5, .map_id = 0, .T_world_camera = T_world_camera});
  result = filter.apply(scene.render(6, 0, 0), std::nullopt);
  EXPECT_NEAR((result.T_world_camera.translation() - Eigen::Vector3d(4, 5, 6)).norm(), 0, 0.005) << "m";
  EXPECT_EQ(result.removed, 0U);
}

TEST_F(DynamicFilterTest, gives_the_same_bits_for_the_same_input) {
  DynamicFilter first = make_filter(FilterMode::kGeometry), second = make_filter(FilterMode::kGeometry);
  for (std::uint64_t i = 0; i < 8; ++i) {
    const vision::RgbdImage image =
        scene.render(i, 0.01 * static_cast<double>(i), -0.2 + 0.03 * static_cast<double>(i));
    const FilterResult a = first.apply(image, std::nullopt), b = second.apply(image, std::nullopt);
    ASSERT_EQ(a.features.size(), b.features.size());
    EXPECT_EQ(std::memcmp(a.features.data(), b.features.data(), a.features.size() * sizeof(msg::Feature)), 0)
        << "frame " << i;
  }
}

}  // namespace
}  // namespace rtd::filter
