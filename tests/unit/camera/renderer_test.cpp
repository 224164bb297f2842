// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/camera/synthetic/figure.hpp"
#include "common/camera/synthetic/renderer.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera::synthetic {
namespace {

constexpr int kWidth = 160, kHeight = 120;

geometry::CameraModel camera() {
  geometry::CameraModel::Parameters parameters;
  parameters.fx = parameters.fy = 130;
  parameters.cx = (kWidth - 1) / 2.0;
  parameters.cy = (kHeight - 1) / 2.0;
  parameters.width = kWidth;
  parameters.height = kHeight;
  return geometry::CameraModel(parameters);
}

/// World = camera frame: the camera looks along +z.
const Eigen::Isometry3d kAtOrigin = Eigen::Isometry3d::Identity();

/// One grey level everywhere.
Texture plain(std::uint8_t level) {
  const std::uint32_t texel = level | level << 8U | level << 16U;
  return {100, {MipLevel{16, 16, std::vector<std::uint32_t>(256, texel)}}};
}

/// A face of 2 m x 2 m that looks at the camera, its middle at `center`.
Face facing_camera(const Eigen::Vector3f& center, bool moving = false) {
  Face face;
  face.axis_s = Eigen::Vector3f::UnitX();
  face.axis_t = -Eigen::Vector3f::UnitY();  // normal -z, towards the camera
  face.width_m = face.height_m = 2;
  face.origin = center - face.axis_s - face.axis_t;
  face.surface.moving = moving;
  return face;
}

float depth_at(const Rendering& rendering, int u, int v) {
  const float inverse = rendering.inverse_depth.at<float>(v, u);
  return inverse > 0 ? 1.0F / inverse : 0.0F;
}

TEST(Renderer, gives_the_planes_depth_and_extent) {
  Renderer renderer(camera());
  const Rendering rendering = renderer.render({{facing_camera({0, 0, 4})}, {}}, {plain(100)}, kAtOrigin);
  EXPECT_NEAR(depth_at(rendering, 80, 60), 4.0F, 1e-5F);
  // 1 m at 4 m is 32.5 px from the centre at 79.5
  EXPECT_GT(depth_at(rendering, 111, 60), 0);
  EXPECT_EQ(depth_at(rendering, 113, 60), 0);
  EXPECT_GT(depth_at(rendering, 80, 28), 0);
  EXPECT_EQ(depth_at(rendering, 80, 26), 0);
  EXPECT_EQ(rendering.color_bgr.at<cv::Vec3b>(60, 80), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(rendering.color_bgr.at<cv::Vec3b>(5, 5), cv::Vec3b(0, 0, 0));
}

TEST(Renderer, depth_is_along_the_optical_axis_of_the_moved_camera) {
  Renderer renderer(camera());
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  T_world_camera.linear() = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T_world_camera.translation() = Eigen::Vector3d(-0.3, 0.1, 0.5);
  const Rendering rendering = renderer.render({{facing_camera({0, 0, 4})}, {}}, {plain(1)}, T_world_camera);
  const Eigen::Vector3d p_world(0.2, -0.1, 4);
  const Eigen::Vector3d p_camera = T_world_camera.inverse() * p_world;
  const Eigen::Vector2d pixel = camera().project(p_camera);
  EXPECT_NEAR(depth_at(rendering, static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))),
              p_camera.z(), 0.01)
      << "half a pixel on a plane slanted by 0.2 rad";
}

TEST(Renderer, does_not_show_faces_from_behind) {
  Renderer renderer(camera());
  Face face = facing_camera({0, 0, 4});
  std::swap(face.axis_s, face.axis_t);
  const Rendering rendering = renderer.render({{face}, {}}, {plain(100)}, kAtOrigin);
  EXPECT_EQ(cv::countNonZero(rendering.inverse_depth), 0);
}

TEST(Renderer, shows_the_nearer_of_two_and_masks_what_moves) {
  Renderer renderer(camera());
  Face near = facing_camera({1, 0, 2}, true);
  near.surface.texture = 1;
  const Rendering rendering =
      renderer.render({{near, facing_camera({0, 0, 4})}, {}}, {plain(50), plain(200)}, kAtOrigin);
  EXPECT_NEAR(depth_at(rendering, 100, 60), 2.0F, 1e-5F);
  EXPECT_EQ(rendering.color_bgr.at<cv::Vec3b>(60, 100)[0], 200);
  EXPECT_EQ(rendering.moving_mask.at<std::uint8_t>(60, 100), 255);
  EXPECT_NEAR(depth_at(rendering, 70, 60), 4.0F, 1e-5F);
  EXPECT_EQ(rendering.moving_mask.at<std::uint8_t>(60, 70), 0);
}

TEST(Renderer, gives_the_bounds_of_what_is_seen_of_an_object) {
  Renderer renderer(camera());
  Geometry geometry;
  Face behind = facing_camera({0, 0, 4}, true), before = facing_camera({1, 0, 2});
  behind.surface.object = geometry.add_object("person");
  geometry.add_object("unseen");
  geometry.faces = {behind, before};
  const Rendering rendering = renderer.render(geometry, {plain(50)}, kAtOrigin);
  const auto objects = synthetic::find_objects(rendering);
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].object, 0);
  EXPECT_TRUE(objects[0].moving);
  // from 79.5 - 32.5 px to the edge of the face before it at 79.5; rows 59.5 -+ 32.5
  EXPECT_EQ(objects[0].bounds_px, cv::Rect(47, 27, 33, 66));
  EXPECT_EQ(objects[0].visible_px, objects[0].bounds_px.area());
}

TEST(Renderer, draws_an_ellipsoid_where_its_surface_is) {
  Renderer renderer(camera());
  Ellipsoid ellipsoid;
  ellipsoid.T_world_body.translation() = Eigen::Vector3f(0, 0, 3);
  ellipsoid.semi_axes_m = Eigen::Vector3f(0.5F, 1.0F, 0.25F);
  ellipsoid.surface.moving = true;
  const Rendering rendering = renderer.render({{}, {ellipsoid}}, {plain(100)}, kAtOrigin);
  EXPECT_NEAR(0.5F * (depth_at(rendering, 79, 59) + depth_at(rendering, 80, 60)), 2.75F, 1e-3F);
  // Silhouette of the ellipse x^2/0.25 + (z-3)^2/0.0625 = 1 from the origin: x/z = 0.5 / sqrt(9 - 0.0625) -> 21.7 px
  EXPECT_GT(depth_at(rendering, 100, 60), 0);
  EXPECT_EQ(depth_at(rendering, 102, 60), 0);
  EXPECT_EQ(rendering.moving_mask.at<std::uint8_t>(60, 80), 255);
}

TEST(Renderer, leaves_out_what_is_behind_the_camera) {
  Renderer renderer(camera());
  Ellipsoid ellipsoid;
  ellipsoid.T_world_body.translation() = Eigen::Vector3f(0, 0, -3);
  const Rendering rendering = renderer.render({{facing_camera({0, 0, -4})}, {ellipsoid}}, {plain(100)}, kAtOrigin);
  EXPECT_EQ(cv::countNonZero(rendering.inverse_depth), 0);
}

TEST(Renderer, closes_the_room_without_cracks) {
  Renderer renderer(camera());
  Cuboid room;
  room.size_m = Eigen::Vector3f(4, 4, 3);
  std::vector<Face> walls;
  for (Face face : outer_faces(room)) {  // seen from inside: swap the axes
    std::swap(face.axis_s, face.axis_t);
    std::swap(face.width_m, face.height_m);
    walls.push_back(face);
  }
  for (int i = 0; i < 20; ++i) {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.translation() = Eigen::Vector3d(0.3 + 0.01 * i, -0.2, 1.4);
    T_world_camera.linear() = Eigen::AngleAxisd(0.37 * i, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
    const Rendering rendering = renderer.render({walls, {}}, {plain(9)}, T_world_camera);
    EXPECT_EQ(cv::countNonZero(rendering.inverse_depth), kWidth * kHeight) << "view " << i;
  }
}

}  // namespace
}  // namespace rtd::camera::synthetic

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
  for (const synthetic::Ellipsoid& part : figure_of(FigureLook::kDrawn, posture).ellipsoids)
    moving += part.surface.moving;
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
