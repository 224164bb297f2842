// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/background.hpp"

#include <gtest/gtest.h>

#include "tests/unit/dense/wall_scene.hpp"

namespace rtd::dense {
namespace {

using test::at_origin;
using test::WallScene;

const cv::Rect kLeft{20, 30, 40, 80}, kRight{100, 30, 40, 80};

class BackgroundTest : public testing::Test {
 protected:
  void see(const cv::Rect& person, double camera_x_m = 0) {
    Eigen::Isometry3d T_world_camera = at_origin();
    T_world_camera.translation().x() = camera_x_m;
    const vision::RgbdImage image = scene_.render(person);
    map_.integrate(image, WallScene::mask(person), T_world_camera);
    painter_.remember(image, WallScene::mask(person), T_world_camera, map_.keyframes());
  }
  /// Share of the pixels of an area that are opaque and show the wall.
  static double wall_share(const cv::Mat& picture, const cv::Rect& area) {
    int wall = 0;
    for (int row = area.y; row < area.y + area.height; ++row) {
      for (int column = area.x; column < area.x + area.width; ++column) {
        wall += picture.at<cv::Vec4b>(row, column) == cv::Vec4b(200, 150, 100, 255) ? 1 : 0;
      }
    }
    return static_cast<double>(wall) / area.area();
  }

  WallScene scene_;
  StaticMap map_{WallScene::config()};
  BackgroundPainter painter_{WallScene::config().fusion, 4};
};

TEST_F(BackgroundTest, shows_the_wall_where_the_person_stands_now) {
  for (int i = 0; i < 3; ++i) see(kLeft);
  for (int i = 0; i < 3; ++i) see(kRight);
  const cv::Mat picture = painter_.paint(map_);
  EXPECT_GT(wall_share(picture, kRight), 0.97);
  EXPECT_GT(wall_share(picture, kLeft), 0.97) << "its own pixels";
}

TEST_F(BackgroundTest, fills_from_a_camera_that_stood_elsewhere) {
  for (int i = 0; i < 3; ++i) see({0, 0, 1, 1}, 0.2);
  see(kLeft);
  EXPECT_GT(wall_share(painter_.paint(map_), kLeft), 0.97);
}

TEST_F(BackgroundTest, is_transparent_where_no_view_looked) {
  for (int i = 0; i < 3; ++i) see(kLeft);
  const cv::Mat picture = painter_.paint(map_);
  EXPECT_EQ(picture.at<cv::Vec4b>(kLeft.y + 40, kLeft.x + 20)[3], 0);
  EXPECT_EQ(picture.at<cv::Vec4b>(5, 5)[3], 255);
}

TEST_F(BackgroundTest, keeps_a_bounded_number_of_views_spread_over_time) {
  for (int i = 0; i < 40; ++i) see(kLeft);
  EXPECT_LE(painter_.views(), 4U);
  EXPECT_GE(painter_.views(), 2U);
}

TEST_F(BackgroundTest, has_no_image_before_the_first_frame) {
  EXPECT_TRUE(painter_.paint(map_).empty());
}

}  // namespace
}  // namespace rtd::dense
