// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/camera/synthetic/figure.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using synthetic::FigureLook;
using ::testing::SizeIs;

const std::string kFourSeconds = "?frames=4&fps=1&noise=0&width=320&height=240";

synthetic::Geometry figure_of(FigureLook look, const synthetic::Posture& posture) {
  std::vector<synthetic::Texture> textures;
  synthetic::Geometry geometry;
  synthetic::Figure(3, look, textures).append_to(geometry, posture);
  return geometry;
}

/// The box round all ellipsoids, world frame.
Eigen::AlignedBox3f extent_m(const synthetic::Geometry& geometry) {
  Eigen::AlignedBox3f box;
  for (const synthetic::Ellipsoid& part : geometry.ellipsoids) {
    const Eigen::Matrix3f axes_m = part.T_world_body.linear() * part.semi_axes_m.asDiagonal();
    const Eigen::Vector3f reach_m = axes_m.rowwise().norm(), center_m = part.T_world_body.translation();
    box.extend(center_m - reach_m);
    box.extend(center_m + reach_m);
  }
  return box;
}

TEST(DrawnFigure, takes_the_room_of_the_plain_one) {
  for (const float seated : {0.0F, 1.0F}) {
    synthetic::Posture posture;
    posture.seated = seated;
    const synthetic::Geometry plain = figure_of(FigureLook::kPlain, posture);
    const synthetic::Geometry drawn = figure_of(FigureLook::kDrawn, posture);
    EXPECT_EQ(drawn.object_classes, plain.object_classes);
    const Eigen::AlignedBox3f expected = extent_m(plain), actual = extent_m(drawn);
    EXPECT_LT((actual.min() - expected.min()).cwiseAbs().maxCoeff(), 0.15F) << actual.min().transpose();
    EXPECT_LT((actual.max() - expected.max()).cwiseAbs().maxCoeff(), 0.15F) << actual.max().transpose();
  }
}

TEST(DrawnFigure, moves_the_parts_that_its_posture_names) {
  synthetic::Posture posture;
  posture.body_moves = false;
  int moving = 0;
  for (const synthetic::Ellipsoid& part : figure_of(FigureLook::kDrawn, posture).ellipsoids) moving += part.moving;
  EXPECT_EQ(moving, 8);  // head, hair, upper arms, forearms, hands
}

TEST(Figures, are_plain_unless_drawn_is_asked_for) {
  const auto unnamed = test::play("synthetic:office" + kFourSeconds);
  const auto plain = test::play("synthetic:office" + kFourSeconds + "&figures=plain");
  ASSERT_THAT(unnamed, SizeIs(plain.size()));
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_TRUE(test::same(unnamed[i].image.color_bgr, plain[i].image.color_bgr));
    EXPECT_TRUE(test::same(unnamed[i].image.depth, plain[i].image.depth));
  }
  EXPECT_THAT(figure_of(FigureLook::kPlain, {}).ellipsoids, SizeIs(8));
}

TEST(Figures, drawn_change_the_people_and_nothing_else) {
  const auto plain = test::play("synthetic:crowd" + kFourSeconds);
  const auto drawn = test::play("synthetic:crowd" + kFourSeconds + "&figures=drawn");
  ASSERT_THAT(drawn, SizeIs(plain.size()));
  for (std::size_t i = 0; i < plain.size(); ++i) {
    cv::Mat difference, people;
    cv::absdiff(plain[i].image.color_bgr, drawn[i].image.color_bgr, difference);
    cv::bitwise_or(plain[i].dynamic_mask, drawn[i].dynamic_mask, people);
    ASSERT_GT(cv::countNonZero(people), 1000);
    EXPECT_GT(cv::mean(difference, people)[1], 10);
    EXPECT_LT(cv::mean(difference, ~people)[1], 0.01);  // a run of pixels that they cut may take another mip level
    EXPECT_TRUE(plain[i].T_world_camera->isApprox(*drawn[i].T_world_camera, 0));
    for (const SourceObject& object : drawn[i].objects) EXPECT_EQ(object.class_name, "person");
  }
}

}  // namespace
}  // namespace rtd::camera
