// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/foreground.hpp"

#include <gtest/gtest.h>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kShape;
using test::put_block;
using test::wall_image;

const cv::Rect kThing(240, 100, 120, 120);

/// A room with features everywhere.
class SurfacesInQuestion : public ::testing::Test {
 protected:
  SurfacesInQuestion()
      : image_(wall_image(3.0)),
        excluded_(static_cast<std::size_t>(kShape.size()), 0),
        asked_(excluded_),
        decided_(excluded_) {}

  CellMask find(int step_px = 20) {
    DepthGridSampler sampler = test::make_sampler();
    const DepthGrid grid = sampler.sample(image_);
    std::vector<msg::Feature> features;
    for (int v = step_px / 2; v < 480; v += step_px) {
      for (int u = step_px / 2; u < 640; u += step_px) {
        msg::Feature feature{};
        feature.u_px = static_cast<float>(u);
        feature.v_px = static_cast<float>(v);
        feature.depth_m = grid.depth_m[static_cast<std::size_t>(kShape.nearest_cell(feature.u_px, feature.v_px))];
        features.push_back(feature);
      }
    }
    const DepthClusters clusters = find_depth_clusters(grid, ClusterConfig{});
    return surfaces_in_question({grid, sampler.rays(), clusters, features}, {excluded_, asked_, decided_}, 0.15);
  }
  static void mark(CellMask& mask, const cv::Rect& area_px) {
    for (int y = area_px.y / kCellPx; y < area_px.br().y / kCellPx; ++y) {
      for (int x = area_px.x / kCellPx; x < area_px.br().x / kCellPx; ++x)
        mask[static_cast<std::size_t>(kShape.index(x, y))] = 1;
    }
  }

  vision::RgbdImage image_;
  CellMask excluded_, asked_, decided_;
};

TEST_F(SurfacesInQuestion, stand_out_from_the_wall_behind) {
  put_block(image_, kThing, 1.5);
  const CellMask mask = find();
  EXPECT_EQ(count_in(kShape, mask, kThing), cells_in(kThing));
  EXPECT_EQ(count_in(kShape, mask, {0, 320, 640, 160}), 0) << "the wall";
}

TEST_F(SurfacesInQuestion, are_no_larger_than_what_is_carried) {
  put_block(image_, {40, 60, 560, 360}, 2.4);  // a partition, 2.6 m wide
  EXPECT_EQ(count_in(kShape, find(10), {0, 0, 640, 480}), 0);
}

TEST_F(SurfacesInQuestion, are_not_behind_most_of_what_is_left) {
  put_block(image_, {0, 0, 640, 400}, 1.5);     // most of the room is near
  put_block(image_, {240, 420, 120, 40}, 2.5);  // and this is not
  EXPECT_EQ(count_in(kShape, find(), {240, 420, 120, 40}), 0);
}

TEST_F(SurfacesInQuestion, leave_enough_features) {
  put_block(image_, {100, 100, 330, 330}, 1.5);
  EXPECT_GT(count_in(kShape, find(20), {0, 0, 640, 480}), 0);
  EXPECT_EQ(count_in(kShape, find(40), {0, 0, 640, 480}), 0) << "of 192 some 60 lie on it";
}

TEST_F(SurfacesInQuestion, stand_out_beside_a_person_at_the_same_depth) {
  const cv::Rect person(120, 60, 120, 400);
  put_block(image_, kThing, 1.5);
  put_block(image_, person, 1.62);  // a surface of its own, nearly as near
  mark(excluded_, person);
  EXPECT_EQ(count_in(kShape, find(), kThing), cells_in(kThing));
}

TEST_F(SurfacesInQuestion, may_be_the_two_halves_of_one_thing) {
  put_block(image_, {240, 100, 60, 120}, 1.5);
  put_block(image_, {300, 100, 60, 120}, 1.6);
  const CellMask mask = find();
  EXPECT_EQ(count_in(kShape, mask, kThing), cells_in(kThing)) << "each ends where the other begins";
}

TEST_F(SurfacesInQuestion, remain_when_they_no_longer_stand_out) {
  put_block(image_, {220, 80, 160, 160}, 0);  // nothing is known around it
  put_block(image_, kThing, 1.5);
  EXPECT_EQ(count_in(kShape, find(), kThing), 0);
  mark(asked_, kThing);
  EXPECT_EQ(count_in(kShape, find(), kThing), cells_in(kThing));
}

TEST_F(SurfacesInQuestion, are_not_asked_again) {
  put_block(image_, kThing, 1.5);
  mark(decided_, kThing);
  EXPECT_EQ(count_in(kShape, find(), kThing), 0);
}

TEST_F(SurfacesInQuestion, are_none_without_depth) {
  put_block(image_, {0, 0, 640, 480}, 0);
  EXPECT_EQ(count_in(kShape, find(), {0, 0, 640, 480}), 0);
}

}  // namespace
}  // namespace rtd::filter
