// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/synthetic/scene.hpp"

#include <gmock/gmock.h>

#include <set>

#include "common/geometry/se3.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using synthetic::build_corridor;
using synthetic::CorridorPlan;
using synthetic::CorridorWalk;
using synthetic::Face;
using synthetic::Texture;

/// Textures that the faces show.
std::size_t textures_of(const CorridorPlan& plan, std::uint64_t seed) {
  std::vector<Texture> textures;
  std::set<int> used;
  for (const Face& face : build_corridor(plan, seed, textures)) used.insert(face.texture);
  EXPECT_EQ(used.size(), textures.size()) << "none is painted in vain";
  return used.size();
}

TEST(Corridor, walk_comes_back_to_its_start) {
  const CorridorPlan plan;
  const CorridorWalk walk(plan, 3);
  EXPECT_GT(walk.lap_m(), 60);
  const Eigen::Isometry3d T_change =
      walk.T_world_camera(0).inverse() * walk.T_world_camera(walk.lap_m() / plan.speed_m_s);
  EXPECT_LT(T_change.translation().norm(), 0.3) << "but for the swaying";
  EXPECT_LT(geometry::rotation_angle_rad(T_change), 0.15);
}

TEST(Corridor, walk_is_steady_and_stays_between_the_walls) {
  const CorridorPlan plan;
  const CorridorWalk walk(plan, 2);
  constexpr double kStepS = 0.1;
  for (double t_s = 0; t_s < 70; t_s += kStepS) {
    const Eigen::Isometry3d now = walk.T_world_camera(t_s), next = walk.T_world_camera(t_s + kStepS);
    ASSERT_LT((next.translation() - now.translation()).norm(), 1.2 * plan.speed_m_s * kStepS);
    ASSERT_LT(geometry::rotation_angle_rad(now.inverse() * next), 0.16) << t_s;
    const Eigen::Vector3d p = now.translation().cwiseAbs();
    const double clearance_m = plan.width_m / 2 - 0.5;
    const bool inside = (std::abs(p.x() - plan.length_m / 2) < clearance_m && p.y() < plan.depth_m / 2 + clearance_m) ||
                        (std::abs(p.y() - plan.depth_m / 2) < clearance_m && p.x() < plan.length_m / 2 + clearance_m) ||
                        (p.x() > plan.length_m / 2 - 1 && p.y() > plan.depth_m / 2 - 1);
    ASSERT_TRUE(inside) << now.translation().transpose();
  }
}

TEST(Corridor, sides_that_look_alike_share_their_textures) {
  CorridorPlan plan{.length_m = 8, .depth_m = 8};
  const std::size_t all_different = textures_of(plan, 4);
  plan.alike = true;
  EXPECT_EQ(4 * textures_of(plan, 4), all_different);
}

TEST(Corridor, alike_places_look_alike_from_alike_poses) {
  std::vector<Texture> textures;
  const std::vector<Face> faces = build_corridor({.length_m = 8, .depth_m = 8, .alike = true}, 4, textures);
  const std::size_t quarter = faces.size() / 4;
  ASSERT_EQ(4 * quarter, faces.size());
  const Eigen::AngleAxisf turn(static_cast<float>(EIGEN_PI / 2), Eigen::Vector3f::UnitZ());
  for (std::size_t i = 0; i < quarter; ++i) {
    EXPECT_EQ(faces[i].texture, faces[i + quarter].texture);
    EXPECT_LT((turn * faces[i].origin - faces[i + quarter].origin).norm(), 1e-4F);
  }
}

TEST(Corridor, frames_agree_with_each_other) {
  const auto frames = test::play("synthetic:corridor?frames=3&noise=0&seed=3");
  const test::Agreement all = test::agreement(frames[0], frames[2], frames[0].dynamic_mask);
  EXPECT_GT(all.pixels, 5000);
  EXPECT_GT(all.share, 0.95);
}

}  // namespace
}  // namespace rtd::camera
