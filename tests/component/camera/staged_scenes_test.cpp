// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "common/camera/synthetic/actors.hpp"
#include "common/camera/synthetic/scene.hpp"
#include "common/geometry/se3.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera {
namespace {

using synthetic::build_corridor;
using synthetic::CorridorPlan;
using synthetic::CorridorWalk;
using synthetic::Face;
using synthetic::Texture;
using test::play;

const std::string kStagedSmall = "&width=160&height=120";

double share(const cv::Mat& mask) {
  return cv::countNonZero(mask) / static_cast<double>(mask.total());
}

class StagedScene : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, StagedScene,
                         ::testing::Values("sitting", "crowd", "fill", "approach", "slow", "flicker"));

TEST_P(StagedScene, repeats_itself_by_seed_only) {
  const auto first = play("synthetic:" + std::string(GetParam()) + "?frames=3&fps=1" + kStagedSmall + "&seed=4");
  const auto again = play("synthetic:" + std::string(GetParam()) + "?frames=3&fps=1" + kStagedSmall + "&seed=4");
  const auto other = play("synthetic:" + std::string(GetParam()) + "?frames=3&fps=1" + kStagedSmall + "&seed=5");
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(test::same(first[i].image.color_bgr, again[i].image.color_bgr));
    EXPECT_TRUE(test::same(first[i].image.depth, again[i].image.depth));
    EXPECT_TRUE(test::same(first[i].dynamic_mask, again[i].dynamic_mask));
    EXPECT_FALSE(test::same(first[i].image.depth, other[i].image.depth));
  }
}

TEST_P(StagedScene, stands_still_where_the_mask_says_so) {
  for (const char* seed : {"1", "2"}) {
    const auto frames = play("synthetic:" + std::string(GetParam()) +
                             "?sit=1&frames=48&fps=8&noise=0&width=320&height=240&seed=" + seed);
    for (const std::size_t i : {0U, 14U, 29U, 44U}) {
      const test::Agreement still = test::agreement(frames[i], frames[i + 3], frames[i].dynamic_mask);
      if (still.pixels < 300) continue;  // covered by movers
      EXPECT_GT(still.share, 0.95) << GetParam() << " seed " << seed << " frame " << i;
    }
  }
}

TEST(SittingScene, keeps_its_person_at_rest_then_moving_then_at_rest) {
  const auto frames = play("synthetic:sitting?sit=2&frames=40&fps=4&fidget=0" + kStagedSmall);
  for (const SourceFrame& frame : frames) {
    const double t_s = static_cast<double>(frame.image.seq) / 4;
    const bool moves = t_s >= 2 && t_s < 2 + synthetic::Sitter::kRiseS + synthetic::Sitter::kWalkS;
    for (const SourceObject& object : frame.objects) {
      EXPECT_EQ(object.moving, moves && object.class_name == "person") << object.class_name << " at " << t_s;
    }
    EXPECT_TRUE(moves || cv::countNonZero(frame.dynamic_mask) == 0) << t_s;
  }
  ASSERT_THAT(frames[0].objects, ::testing::SizeIs(2));
  EXPECT_EQ(frames[0].objects[0].class_name, "chair");
}

TEST(SittingScene, shows_its_person_nearly_always) {
  for (const char* seed : {"1", "2", "3", "4", "5"}) {
    int seen = 0;
    const auto frames = play(std::string("synthetic:sitting?frames=20&fps=1&seed=") + seed + kStagedSmall);
    for (const SourceFrame& frame : frames) {
      const auto person = std::find_if(frame.objects.begin(), frame.objects.end(),
                                       [](const SourceObject& object) { return object.class_name == "person"; });
      if (person != frame.objects.end() && person->visible_px > 300) ++seen;
    }
    EXPECT_GE(seen, 14) << "seed " << seed;
  }
}

TEST(SittingScene, fidgets_with_arms_and_head_alone) {
  const auto frames = play("synthetic:sitting?frames=1");
  const double moving = share(frames[0].dynamic_mask);
  double person = 0;
  for (const SourceObject& object : frames[0].objects) {
    if (object.class_name == "person") person = object.visible_px / (640.0 * 480);
  }
  EXPECT_GT(moving, 0.05 * person);
  EXPECT_LT(moving, 0.6 * person);
}

TEST(Figure, sits_with_its_feet_on_the_floor_and_its_hips_on_the_seat) {
  std::vector<synthetic::Texture> textures;
  const synthetic::Figure figure(1, synthetic::FigureLook::kPlain, textures);
  const auto top_when = [&](float seated) {
    synthetic::Geometry geometry;
    synthetic::Posture posture;
    posture.seated = seated;
    figure.append_to(geometry, posture);
    float top_m = 0;
    for (const synthetic::Ellipsoid& part : geometry.ellipsoids) {
      top_m = std::max(top_m, part.T_world_body.translation().z());
    }
    return top_m;
  };
  EXPECT_NEAR(top_when(0) - top_when(1), 0.38F, 0.06F) << "m that the head comes down";
  EXPECT_GT(top_when(0.5F), top_when(1));
}

TEST(FillScene, has_a_person_who_covers_four_fifths_of_the_view_for_some_seconds) {
  for (const char* seed : {"1", "2", "3", "4", "5", "6"}) {
    const auto frames = play(std::string("synthetic:fill?frames=40&fps=5&seed=") + seed + kStagedSmall);
    double covered = 0;
    for (std::size_t i = 15; i <= 27; ++i) covered += share(frames[i].dynamic_mask) / 13;
    EXPECT_GT(covered, 0.72) << "seed " << seed;
    EXPECT_LT(covered, 0.92) << "seed " << seed;
    EXPECT_LT(share(frames[0].dynamic_mask), 0.3);
    EXPECT_LT(share(frames[39].dynamic_mask), 0.3);
  }
}

TEST(ApproachScene, moves_its_box_along_the_viewing_axis) {
  int smallest = 1 << 20, largest = 0;
  for (const SourceFrame& frame : play("synthetic:approach?frames=40&fps=4" + kStagedSmall)) {
    ASSERT_THAT(frame.objects, ::testing::SizeIs(1));
    const cv::Rect& box = frame.objects[0].box_px;
    EXPECT_NEAR(box.x + box.width / 2, 80, 30);
    EXPECT_NEAR(box.y + box.height / 2, 60, 30);
    smallest = std::min(smallest, box.area());
    largest = std::max(largest, box.area());
  }
  EXPECT_GT(largest, 4 * smallest);
}

TEST(SlowScene, moves_its_boxes_by_centimetres_a_second) {
  std::vector<synthetic::Texture> textures;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const synthetic::SlowBox box(seed, {}, textures);
    const auto corner_m = [&](double t_s) {
      synthetic::Geometry geometry;
      box.append_to(geometry, t_s);
      return geometry.faces[0].origin;
    };
    for (double t_s = 0; t_s < 60; t_s += 7.3) {
      const float speed_m_s = (corner_m(t_s + 0.1) - corner_m(t_s)).norm() / 0.1F;
      EXPECT_LT(speed_m_s, synthetic::SlowBox::kFastestMS + 0.001F);
    }
    EXPECT_GT((corner_m(1) - corner_m(0)).norm(), 0.5F * synthetic::SlowBox::kSlowestMS);
  }
}

TEST(FlickerScene, changes_the_light_and_nothing_else) {
  const std::string parameters = "?people=2&boxes=0&frames=30&fps=5&noise=0" + kStagedSmall;
  const auto lit = play("synthetic:office" + parameters), unsteady = play("synthetic:flicker" + parameters);
  const auto half = play("synthetic:office" + parameters + "&flicker=0.5");
  double darkest = 1e9, brightest = 0, darkest_half = 1e9;
  for (std::size_t i = 0; i < lit.size(); ++i) {
    EXPECT_TRUE(test::same(lit[i].image.depth, unsteady[i].image.depth));
    EXPECT_TRUE(test::same(lit[i].dynamic_mask, unsteady[i].dynamic_mask));
    const auto gain = [&](const SourceFrame& frame) {
      return cv::mean(frame.image.color_bgr)[1] / cv::mean(lit[i].image.color_bgr)[1];
    };
    darkest = std::min(darkest, gain(unsteady[i]));
    brightest = std::max(brightest, gain(unsteady[i]));
    darkest_half = std::min(darkest_half, gain(half[i]));
  }
  EXPECT_LT(darkest, 0.65);
  EXPECT_GT(darkest, 0.2);
  EXPECT_GT(brightest, 1.05);
  EXPECT_GT(darkest_half, darkest);
}

/// Textures that the faces show.
std::size_t textures_of(const CorridorPlan& plan, std::uint64_t seed) {
  std::vector<Texture> textures;
  std::set<int> used;
  for (const Face& face : build_corridor(plan, seed, textures)) used.insert(face.surface.texture);
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
    EXPECT_EQ(faces[i].surface.texture, faces[i + quarter].surface.texture);
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
