// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "services/filter/core/movers/object_sighting.hpp"
#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::put_block;
using test::wall_image;

const cv::Rect kNear(240, 120, 120, 280), kFar(360, 140, 80, 250);  // the second is hidden by a third of its width
constexpr float kNearM = 1.5F, kFarM = 2.2F;

vision::Detection person(const cv::Rect& box) {
  return {"person",
          0.9F,
          static_cast<float>(box.x),
          static_cast<float>(box.y),
          static_cast<float>(box.width),
          static_cast<float>(box.height)};
}

/// What the filter says of two blocks before a wall when everything before it moves.
std::vector<ObjectSighting> sight(const std::vector<vision::Detection>& persons,
                                  std::vector<TrackedMover> movers = {}) {
  vision::RgbdImage image = wall_image(3.0);
  put_block(image, kFar, kFarM);
  put_block(image, kNear, kNearM);
  DepthGridSampler sampler = test::make_sampler();
  const DepthGrid grid = sampler.sample(image);
  std::vector<ObjectBox> boxes;
  for (const vision::Detection& detection : persons)
    boxes.push_back({detection, static_cast<int>(boxes.size()), 0, false, 0});
  const auto objects = find_objects(boxes, MotionLevels{}, image.camera, grid, find_depth_clusters(grid, {}), {});
  Verdict verdict;
  verdict.movers = std::move(movers);
  CellMask dynamic(grid.depth_m.size(), 0);
  for (std::size_t cell = 0; cell < dynamic.size(); ++cell) dynamic[cell] = grid.depth_m[cell] < 2.9F ? 1 : 0;
  verdict.motion = to_cell_motion(dilate(grid.shape, dynamic, 1), true);
  const auto color = [](std::size_t) { return cv::Vec3b(); };
  return sight_objects(objects, verdict, {grid, sampler.rays(), color});
}

double farthest_m(const ObjectSighting& sighting) {
  return std::ranges::max(sighting.points, {}, [](const SeenPoint& point) { return point.p_camera_m.z(); })
      .p_camera_m.z();
}
double nearest_m(const ObjectSighting& sighting) {
  return std::ranges::min(sighting.points, {}, [](const SeenPoint& point) { return point.p_camera_m.z(); })
      .p_camera_m.z();
}

/// The box of the farther one begins in the middle of the nearer one, as a detector guesses it.
TEST(ObjectSighting, of_two_whose_boxes_overlap_each_shows_its_own_body) {
  const auto sightings = sight({person(kNear), person({310, 140, 130, 250})});
  ASSERT_EQ(sightings.size(), 2U);
  EXPECT_NEAR(nearest_m(sightings[0]), kNearM, 0.01);
  EXPECT_NEAR(farthest_m(sightings[0]), kNearM, 0.01);
  EXPECT_NEAR(nearest_m(sightings[1]), kFarM, 0.01);
  EXPECT_NEAR(farthest_m(sightings[1]), kFarM, 0.01);
  EXPECT_TRUE(sightings[1].cut_left) << "it continues behind the nearer one";
  EXPECT_FALSE(sightings[1].cut_right);
}

TEST(ObjectSighting, a_surface_that_moves_beside_all_objects_has_no_source) {
  const auto sightings = sight({person(kNear)});
  ASSERT_EQ(sightings.size(), 2U);
  EXPECT_EQ(sightings[0].source, 0U);
  EXPECT_FALSE(sightings[1].source.has_value());
  EXPECT_NEAR(nearest_m(sightings[1]), kFarM, 0.01);
}

TEST(ObjectSighting, a_mover_without_a_class_does_not_consist_of_a_person) {
  TrackedMover mover;
  mover.extent_world = {Eigen::Vector3d(-1, -1, 1.3), Eigen::Vector3d(1, 1, 2.4)};  // both of them
  const auto sightings = sight({person(kNear)}, {mover});
  ASSERT_EQ(sightings.size(), 2U);
  EXPECT_EQ(sightings[1].source, 1U);
  EXPECT_NEAR(nearest_m(sightings[1]), kFarM, 0.01);
  EXPECT_EQ(sight({person(kNear), person(kFar)}, {mover}).size(), 2U) << "nothing is left of it";
}

ColorHistogram shares_of(const std::vector<cv::Vec3b>& colors_bgr) {
  ColorHistogram shares = ColorHistogram::Zero();
  for (const cv::Vec3b& color : colors_bgr) shares[tint_of(color)] += 1.0 / static_cast<double>(colors_bgr.size());
  return shares;
}

TEST(Tint, keeps_every_color_within_its_classes) {
  std::set<int> tints;
  for (int b = 0; b <= 255; b += 15) {
    for (int g = 0; g <= 255; g += 15) {
      for (int r = 0; r <= 255; r += 15) tints.insert(tint_of(cv::Vec3b(b, g, r)));
    }
  }
  EXPECT_EQ(tints.size(), static_cast<std::size_t>(kTints)) << "each occurs";
  EXPECT_EQ(*tints.begin(), 0);
  EXPECT_EQ(*tints.rbegin(), kTints - 1);
}

TEST(Tint, is_the_same_in_shade_where_there_is_hue) {
  EXPECT_EQ(tint_of({40, 40, 200}), tint_of({24, 24, 120}));
  EXPECT_NE(tint_of({40, 40, 200}), tint_of({200, 40, 40}));
  EXPECT_NE(tint_of({20, 20, 20}), tint_of({230, 230, 230})) << "greys differ by brightness only";
}

TEST(Tint, distinguishes_surfaces_and_reports_nothing_about_unknown_ones) {
  const ColorHistogram red_and_dark = shares_of({{40, 40, 200}, {40, 40, 200}, {20, 20, 20}});
  const ColorHistogram mostly_red = shares_of({{40, 40, 200}, {40, 40, 200}, {40, 40, 200}, {20, 20, 20}});
  const ColorHistogram blue = shares_of({{200, 40, 40}});
  EXPECT_NEAR(histogram_distance(red_and_dark, red_and_dark), 0, 1e-12);
  EXPECT_LT(histogram_distance(red_and_dark, mostly_red), 0.05);
  EXPECT_NEAR(histogram_distance(red_and_dark, blue), 1, 1e-12);
  EXPECT_EQ(histogram_distance(red_and_dark, ColorHistogram::Zero()), 0);
}

}  // namespace
}  // namespace rtd::filter
