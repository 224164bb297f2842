// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/epipolar_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/se3.hpp"
#include "tests/unit/filter/grid_scenes.hpp"
#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;
using test::removed_share;

/// Exact matches of points of a room, and of a mover, between two poses of the camera.
class EpipolarCheckTest : public ::testing::Test {
 protected:
  void add(int count, const cv::Rect& area, double min_depth_m, double max_depth_m,
           const Eigen::Vector3d& moved_m = Eigen::Vector3d::Zero()) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height),
        z(min_depth_m, max_depth_m);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d before(u(random_), v(random_));
      const Eigen::Vector3d p_now = T_now_before_ * (camera_.unproject(before, z(random_)) + moved_m);
      const Eigen::Vector2d now = camera_.project(p_now);
      matches_.push_back({{static_cast<float>(before.x()), static_cast<float>(before.y())},
                          {static_cast<float>(now.x()), static_cast<float>(now.y())}});
    }
  }
  std::size_t moving() const { return find_moving_points(matches_, camera_).size(); }

  std::mt19937_64 random_{3};
  geometry::CameraModel camera_ = test::pinhole();
  Eigen::Isometry3d T_now_before_ =
      geometry::se3_exp((geometry::Vector6d() << 0.03, 0.005, -0.02, 0.01, -0.02, 0.015).finished());
  std::vector<FlowMatch> matches_;
};

TEST_F(EpipolarCheckTest, finds_nothing_in_a_static_room) {
  add(200, {20, 20, 600, 440}, 1.5, 4.0);
  EXPECT_EQ(moving(), 0U);
}

TEST_F(EpipolarCheckTest, finds_the_points_of_a_mover) {
  add(200, {20, 20, 600, 440}, 1.5, 4.0);
  add(60, {240, 120, 160, 240}, 1.2, 1.4, {0.01, 0.03, 0});  // across the epipolar lines
  EXPECT_NEAR(static_cast<double>(moving()), 60, 6);
}

TEST_F(EpipolarCheckTest, does_not_see_motion_along_the_epipolar_lines) {
  T_now_before_ = Eigen::Isometry3d::Identity();
  T_now_before_.translation().x() = -0.03;
  add(200, {20, 20, 600, 440}, 1.5, 4.0);
  add(60, {240, 120, 160, 240}, 1.2, 1.4, {0.03, 0, 0});  // the weakness of the check
  EXPECT_LE(moving(), 6U);
}

TEST_F(EpipolarCheckTest, takes_a_camera_that_only_turns_for_no_motion) {
  T_now_before_ = geometry::se3_exp((geometry::Vector6d() << 0, 0, 0, 0.02, -0.03, 0.05).finished());
  add(200, {40, 40, 560, 400}, 1.5, 4.0);
  EXPECT_EQ(moving(), 0U) << "the matrix is not unique, but every one of them fits";
}

TEST_F(EpipolarCheckTest, takes_one_plane_for_no_motion) {
  add(200, {40, 40, 560, 400}, 2.0, 2.0);
  EXPECT_EQ(moving(), 0U);
}

TEST_F(EpipolarCheckTest, makes_no_statement_from_few_or_degenerate_matches) {
  EXPECT_EQ(moving(), 0U) << "none";
  add(15, {20, 20, 600, 440}, 1.5, 4.0, {0, 0.1, 0});
  EXPECT_EQ(moving(), 0U) << "15";
  matches_.assign(100, {{100, 100}, {102, 101}});
  EXPECT_EQ(moving(), 0U) << "all the same";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  matches_.assign(100, {{100, 100}, {nan, nan}});
  EXPECT_EQ(moving(), 0U) << "not finite";
}

TEST_F(EpipolarCheckTest, gives_the_same_result_twice) {
  add(200, {20, 20, 600, 440}, 1.5, 4.0);
  add(60, {240, 120, 160, 240}, 1.2, 1.4, {0.01, 0.03, 0});
  EXPECT_EQ(find_moving_points(matches_, camera_), find_moving_points(matches_, camera_));
}

TEST(FollowCorners, drop_corners_that_leave_the_image_or_look_different) {
  const cv::Mat image = test::textured_image();
  cv::Mat shifted;
  const cv::Mat affine = (cv::Mat_<double>(2, 3) << 1, 0, 4, 0, 1, 0);
  cv::warpAffine(image, shifted, affine, image.size(), cv::INTER_LINEAR);
  const auto matches = follow_corners(image, shifted);
  EXPECT_GT(matches.size(), 300U);
  const auto right = std::count_if(matches.begin(), matches.end(), [](const FlowMatch& match) {
    return std::abs(match.now.x - match.before.x - 4) < 0.5F && std::abs(match.now.y - match.before.y) < 0.5F;
  });
  EXPECT_GE(static_cast<double>(right), 0.98 * static_cast<double>(matches.size()));
  for (const FlowMatch& match : matches) EXPECT_LT(match.now.x, 640 - 5);
  EXPECT_LT(follow_corners(image, test::textured_image({640, 480}, 99)).size(), matches.size() / 4)
      << "another picture";
  EXPECT_TRUE(follow_corners(cv::Mat(480, 640, CV_8UC1, cv::Scalar(0)), image).empty()) << "no corners";
}

FilterConfig epipolar_config() {
  FilterConfig config;
  config.mode = FilterMode::kEpipolar;
  return config;
}

/// The camera goes sideways past two walls, a block in a box of this class goes up: across the epipolar lines.
class EpipolarJudgeTest : public ::testing::Test {
 protected:
  double removed_of_block(const std::string& class_name, int block_step_px) {
    DynamicFilter filter(epipolar_config(), [] { return std::int64_t{0}; });
    FilterResult result;
    cv::Rect block;
    for (int i = 0; i < 4; ++i) {
      block = {250 - 5 * i, 200 - block_step_px * i, 140, 200};
      const std::vector<vision::Detection> boxes{
          {class_name, 0.9F, static_cast<float>(block.x - 10), static_cast<float>(block.y - 10), 160, 220}};
      result = filter.apply(render(i, block), boxes);
    }
    EXPECT_EQ(removed_share(result, block, false), 0.0) << "elsewhere everything stays";
    return removed_share(result, block, true);
  }

 private:
  vision::RgbdImage render(int i, const cv::Rect& block) const {
    cv::Mat grey(480, 640, CV_8UC1);
    wall_(cv::Rect(2 * i, 0, 640, 240)).copyTo(grey(cv::Rect(0, 0, 640, 240)));
    wall_(cv::Rect(4 * i, 240, 640, 240)).copyTo(grey(cv::Rect(0, 240, 640, 240)));
    block_(cv::Rect(0, 0, block.width, block.height)).copyTo(grey(block));
    vision::RgbdImage image = test::rgbd_image(grey, 3.0);
    image.depth(block).setTo(cv::Scalar(1.5 / image.depth_scale_m));
    image.seq = static_cast<std::uint64_t>(i);
    image.stamp_ns = 33'333'333L * i;
    return image;
  }
  cv::Mat wall_ = test::textured_image({700, 480}, 1), block_ = test::textured_image({200, 200}, 3);
};

TEST_F(EpipolarJudgeTest, removes_a_person_that_moves_and_keeps_one_that_stands) {
  EXPECT_EQ(removed_of_block("person", 6), 1.0);
  EXPECT_EQ(removed_of_block("person", 0), 0.0);
}

TEST_F(EpipolarJudgeTest, removes_people_only) {
  EXPECT_EQ(removed_of_block("dog", 6), 0.0);
}

TEST_F(EpipolarJudgeTest, removes_nothing_in_the_first_frame_and_without_a_detector) {
  const MovingScene scene;
  DynamicFilter filter(epipolar_config(), [] { return std::int64_t{0}; });
  const std::vector<vision::Detection> person{{"person", 0.9F, 240, 110, 160, 240}};
  EXPECT_EQ(filter.apply(scene.render(0, 0, 0), person).removed, 0U);
  EXPECT_EQ(filter.apply(scene.render(1, 0, 0.1), std::nullopt).removed, 0U);
}

TEST_F(EpipolarJudgeTest, needs_more_than_a_few_moving_points_on_a_mask) {
  const vision::RgbdImage image = test::rgbd_image(test::textured_image());
  const std::vector<SceneObject> person{{"person", 0.9F, MotionLevel::kHigh, {0, 1, 2}, false}};
  const test::TestScene scene(image);
  const auto masked = [&](std::size_t points) {
    return moving_masks(scene.with(person), std::vector<cv::Point2f>(points, {5, 1}), EpipolarConfig{}.max_still_points,
                        0)[1];
  };
  EXPECT_EQ(masked(static_cast<std::size_t>(EpipolarConfig{}.max_still_points)), 0);
  EXPECT_EQ(masked(static_cast<std::size_t>(EpipolarConfig{}.max_still_points) + 1), 1);
}

}  // namespace
}  // namespace rtd::filter
