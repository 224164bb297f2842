// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/motion/undecided_surfaces.hpp"
#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kBlock;
using test::kShape;

constexpr std::size_t kRegionCells = 160 * 120;

/// A wall with a block in front, as clusters, and evidence that starts empty.
constexpr int kElapsedCs = 3;  // from frame to frame

class DynamicRegionsTest : public ::testing::Test {
 protected:
  DynamicRegionsTest() {
    vision::RgbdImage image = test::wall_image(3.0);
    test::put_block(image, kBlock, 1.5);
    clusters_ = find_depth_clusters(test::make_sampler().sample(image), ClusterConfig{});
    votes_.resting.assign(clusters_.cells.size(), 0);
    votes_.moving.assign(clusters_.cells.size(), 0);
  }
  static void set(CellMask& cells, const cv::Rect& area_px, std::uint8_t value) {
    for (int y = area_px.y / kCellPx; y < (area_px.y + area_px.height) / kCellPx; ++y) {
      for (int x = area_px.x / kCellPx; x < (area_px.x + area_px.width) / kCellPx; ++x) {
        cells[static_cast<std::size_t>(kShape.index(x, y))] = value;
      }
    }
  }
  void set_labels(const cv::Rect& area_px, std::int32_t label) {
    CellMask area(kRegionCells, 0);
    set(area, area_px, 1);
    for (std::size_t cell = 0; cell < kRegionCells; ++cell) {
      if (area[cell] != 0) clusters_.label[cell] = label;
    }
  }
  DynamicRegions judge() const {
    return find_dynamic_regions(clusters_, evidence_, {votes_, slow_votes_}, {remembered_, kElapsedCs}, config_);
  }
  void vote(const cv::Point& pixel, bool moving) {
    const int cell = kShape.cell_at(pixel.x, pixel.y);
    votes_.votes.push_back({cell, moving});
    ++(moving ? votes_.moving
              : votes_.resting)[static_cast<std::size_t>(clusters_.label[static_cast<std::size_t>(cell)])];
  }

  GeometryConfig config_;
  DepthClusters clusters_;
  DepthEvidence evidence_ = DepthEvidence::none(kRegionCells);
  FeatureVotes votes_;
  FeatureVotes slow_votes_;
  CellMask remembered_ = CellMask(kRegionCells, 0);
};

TEST_F(DynamicRegionsTest, takes_the_whole_cluster_when_a_part_of_it_violates) {
  set(evidence_.consistent, kBlock, 2);
  set(evidence_.violated, {240, 160, 40, 160}, 1);  // the leading third
  const DynamicRegions regions = judge();
  EXPECT_EQ(regions.clusters, 1);
  EXPECT_EQ(count_in(kShape, regions.hold_cs, kBlock), cells_in(kBlock));
  EXPECT_EQ(count_in(kShape, regions.hold_cs, {0, 0, 640, 480}), cells_in(kBlock)) << "and not the wall";
}

TEST_F(DynamicRegionsTest, takes_the_cluster_whose_features_are_displaced) {
  for (int i = 0; i < config_.min_moving_features; ++i) vote({250 + 8 * i, 200}, true);
  EXPECT_EQ(count_in(kShape, judge().hold_cs, kBlock), cells_in(kBlock));
}

TEST_F(DynamicRegionsTest, takes_the_cluster_that_is_displaced_over_a_second_only) {
  slow_votes_ = votes_;
  const auto block = static_cast<std::size_t>(clusters_.label[static_cast<std::size_t>(kShape.cell_at(300, 200))]);
  for (int i = 0; i < 20; ++i) vote({250, 170 + 5 * i}, false);
  slow_votes_.moving[block] = config_.min_creeping_features;
  EXPECT_EQ(count_in(kShape, judge().hold_cs, kBlock), cells_in(kBlock));
  slow_votes_.resting[block] = config_.min_creeping_features;
  EXPECT_EQ(judge().clusters, 0);
}

TEST_F(DynamicRegionsTest, a_few_slow_votes_move_no_cluster_with_many_features_at_rest) {
  slow_votes_ = votes_;
  const auto block = static_cast<std::size_t>(clusters_.label[static_cast<std::size_t>(kShape.cell_at(300, 200))]);
  slow_votes_.moving[block] = config_.min_creeping_features;
  for (int i = 0; i < 6 * config_.min_creeping_features; ++i) vote({250 + i, 170 + i}, false);
  EXPECT_EQ(judge().clusters, 1);
  vote({250, 170}, false);
  EXPECT_EQ(judge().clusters, 0);
}

TEST_F(DynamicRegionsTest, leaves_a_cluster_with_a_few_displaced_features_alone) {
  for (int i = 0; i < config_.min_moving_features; ++i) vote({250 + 8 * i, 200}, true);
  for (int i = 0; i < 20; ++i) vote({250, 170 + 5 * i}, false);
  EXPECT_EQ(judge().clusters, 0);
}

TEST_F(DynamicRegionsTest, ignores_specks_and_edges) {
  set(evidence_.consistent, {0, 0, 640, 480}, 2);
  set(evidence_.violated, {40, 40, 16, 16}, 1);
  set(evidence_.violated, {0, 300, 640, 4}, 1);
  EXPECT_EQ(count_in(kShape, judge().hold_cs, {0, 0, 640, 480}), 0);
}

TEST_F(DynamicRegionsTest, takes_a_compact_part_of_a_resting_surface) {
  set(evidence_.consistent, {0, 0, 640, 480}, 2);
  const cv::Rect part(40, 40, 80, 80);
  set(evidence_.violated, part, 1);
  const DynamicRegions regions = judge();
  EXPECT_EQ(regions.clusters, 0);
  EXPECT_EQ(count_in(kShape, regions.hold_cs, part), cells_in(part) - 4) << "all but its corners";
}

TEST_F(DynamicRegionsTest, remembers_a_mover_that_pauses_for_a_while) {
  set(evidence_.consistent, kBlock, 2);
  set(remembered_, kBlock, 30);
  EXPECT_EQ(count_in(kShape, judge().hold_cs, kBlock), cells_in(kBlock));
  EXPECT_EQ(judge().hold_cs[static_cast<std::size_t>(kShape.cell_at(300, 240))], 27);
  set(remembered_, kBlock, 3);
  EXPECT_EQ(count_in(kShape, judge().hold_cs, kBlock), 0) << "the last frame of memory";
}

TEST_F(DynamicRegionsTest, forgets_faster_what_depth_and_features_see_at_rest) {
  set(evidence_.consistent, kBlock, 2);
  set(remembered_, kBlock, 30);
  for (int i = 0; i < 20; ++i) vote({250, 170 + 5 * i}, false);
  EXPECT_EQ(judge().hold_cs[static_cast<std::size_t>(kShape.cell_at(300, 240))], 18);
}

TEST_F(DynamicRegionsTest, leaves_out_the_floor_under_a_walker) {
  for (std::size_t cell = 0; cell < kRegionCells; ++cell) clusters_.label[cell] = cell >= 80 * 160 ? 0 : -1;
  set_labels(kBlock, 0);  // walker and floor in one cluster
  clusters_.cells = {static_cast<int>(kRegionCells * 2 / 5)};
  votes_.resting.assign(1, 0);
  votes_.moving.assign(1, 0);
  const cv::Rect floor(0, 380, 640, 100);
  set(evidence_.consistent, floor, 2);
  set(evidence_.lasting, floor, 1);
  set(evidence_.violated, kBlock, 1);
  for (int i = 0; i < 30; ++i) vote({20 * i + 20, 420}, false);
  const DynamicRegions regions = judge();
  EXPECT_EQ(count_in(kShape, regions.hold_cs, kBlock), cells_in(kBlock));
  EXPECT_EQ(count_in(kShape, regions.hold_cs, {8, 388, 624, 88}), 0);
}

TEST_F(DynamicRegionsTest, makes_no_statement_when_nearly_everything_moves) {
  set(evidence_.violated, {0, 0, 640, 480}, 1);
  const DynamicRegions regions = judge();
  EXPECT_FALSE(regions.trusted);
  EXPECT_EQ(count_in(kShape, regions.hold_cs, {0, 0, 640, 480}), 0);
}

/// Remembers a block at 1.5 m as dynamic for 20 frames.
class DynamicMemoryTest : public ::testing::Test {
 protected:
  DynamicMemoryTest() {
    const DepthGrid grid = sampler_.sample(block_at(kBlock, 1.5));
    std::vector<std::uint8_t> hold_cs(grid.depth_m.size(), 0);
    for (std::size_t i = 0; i < hold_cs.size(); ++i) hold_cs[i] = grid.depth_m[i] < 2 ? 20 : 0;
    memory_.store(grid, sampler_.rays(), hold_cs);
  }
  static vision::RgbdImage block_at(const cv::Rect& area, double depth_m) {
    vision::RgbdImage image = test::wall_image(3.0);
    test::put_block(image, area, depth_m);
    return image;
  }
  std::vector<std::uint8_t> recall(const vision::RgbdImage& image, const Eigen::Isometry3d& T_current_last) {
    return memory_.recall(sampler_.sample(image), image.camera, T_current_last, 0.033);
  }
  DepthGridSampler sampler_ = test::make_sampler();
  DynamicMemory memory_;
};

TEST_F(DynamicMemoryTest, finds_the_block_again) {
  const auto hold_cs = recall(block_at(kBlock, 1.45), Eigen::Isometry3d::Identity());
  EXPECT_EQ(count_in(kShape, hold_cs, kBlock), cells_in(kBlock));
  EXPECT_EQ(hold_cs[static_cast<std::size_t>(kShape.cell_at(300, 240))], 20);
}

TEST_F(DynamicMemoryTest, follows_the_motion_of_the_camera) {
  Eigen::Isometry3d T_current_last = Eigen::Isometry3d::Identity();
  T_current_last.translation().x() = -0.2;  // the camera has gone right, the block appears 70 px farther left
  const cv::Rect shifted = kBlock - cv::Point(70, 0);
  EXPECT_GT(count_in(kShape, recall(block_at(shifted, 1.5), T_current_last), shifted), cells_in(shifted) * 9 / 10);
}

TEST_F(DynamicMemoryTest, forgets_the_place_once_the_block_has_left) {
  EXPECT_EQ(count_in(kShape, recall(test::wall_image(3.0), Eigen::Isometry3d::Identity()), {0, 0, 640, 480}), 0);
}

TEST_F(DynamicMemoryTest, is_empty_after_clear) {
  memory_.clear();
  EXPECT_EQ(count_in(kShape, recall(block_at(kBlock, 1.5), Eigen::Isometry3d::Identity()), {0, 0, 640, 480}), 0);
}

constexpr std::size_t kSurfaceCells = 100;

/// One surface that keyframes saw through and recent views saw at its place.
class Arrivals : public ::testing::Test {
 protected:
  DepthEvidence accept() { return accept_arrivals(evidence_, clusters_, votes_, old_votes_, GeometryConfig{}); }
  DepthClusters clusters_{{10, 10}, std::vector<std::int32_t>(kSurfaceCells, 0), {100}};
  FeatureVotes votes_{{}, {40}, {0}}, old_votes_{{}, {30}, {0}};
  DepthEvidence evidence_ = [] {
    DepthEvidence evidence = DepthEvidence::none(kSurfaceCells);
    evidence.violated.assign(kSurfaceCells, 1);
    evidence.settled.assign(kSurfaceCells, 1);
    return evidence;
  }();
};

TEST_F(Arrivals, are_at_rest_when_their_features_are) {
  EXPECT_EQ(accept().violated, std::vector<std::uint8_t>(kSurfaceCells, 0));
  EXPECT_EQ(accept().lasting, std::vector<std::uint8_t>(kSurfaceCells, 1));
}

TEST_F(Arrivals, are_none_while_features_are_displaced_few_or_new_or_a_recent_view_sees_through_the_surface) {
  const FeatureVotes many = votes_, old = old_votes_, few{{}, {5}, {0}};
  votes_.moving = {10};
  EXPECT_EQ(accept().violated, evidence_.violated);
  votes_ = few;
  EXPECT_EQ(accept().violated, evidence_.violated);
  votes_ = many;
  old_votes_ = few;
  EXPECT_EQ(accept().violated, evidence_.violated) << "new at the place";
  old_votes_ = old;
  for (std::size_t cell = 0; cell < 6; ++cell) evidence_.settled[cell] = 0;
  EXPECT_EQ(accept().violated, evidence_.violated);
}

/// A camera at rest before a wall and a thing; the thing is the nearest cluster.
class SurfaceQuestionsTest : public ::testing::Test {
 protected:
  SurfaceQuestionsTest() : sampler_(test::make_sampler()) {
    test::put_block(image_, test::kBlock, 1.5);
    grid_ = sampler_.sample(image_);
    clusters_ = find_depth_clusters(grid_, ClusterConfig{});
    for (int i = 0; i < 600; ++i) {
      msg::Feature feature{};
      feature.u_px = static_cast<float>(10 + 20 * (i % 31));
      feature.v_px = static_cast<float>(10 + 20 * (i / 31));
      feature.depth_m = grid_.depth_m[static_cast<std::size_t>(kShape.nearest_cell(feature.u_px, feature.v_px))];
      features_.push_back(feature);
    }
  }
  /// One frame; all surfaces get the same vote.
  UndecidedSurfaces frame(SurfaceVote vote) {
    const CellMask none(static_cast<std::size_t>(kShape.size()), 0);
    decisions_.recall(grid_, image_.camera, Eigen::Isometry3d::Identity(), 0.033);
    UndecidedSurfaces undecided = decisions_.find({grid_, sampler_.rays(), clusters_, features_}, none, 0.15);
    decisions_.update(undecided, clusters_, std::vector<SurfaceVote>(clusters_.cells.size(), vote));
    decisions_.store(grid_, sampler_.rays());
    return undecided;
  }
  static int on_thing(const CellMask& mask) { return count_in(kShape, mask, test::kBlock); }

  vision::RgbdImage image_ = test::wall_image(3.0);
  DepthGridSampler sampler_;
  DepthGrid grid_;
  DepthClusters clusters_;
  std::vector<msg::Feature> features_;
  SurfaceDecisions decisions_;
  const int all_ = cells_in(test::kBlock);
};

TEST_F(SurfaceQuestionsTest, stay_open_without_votes) {
  for (int i = 0; i < 5; ++i) {
    const UndecidedSurfaces undecided = frame(SurfaceVote::kNone);
    EXPECT_EQ(on_thing(undecided.open), all_);
    EXPECT_EQ(on_thing(undecided.moving), 0);
    EXPECT_EQ(count_in(kShape, undecided.open, {0, 0, 640, 100}), 0) << "the wall";
  }
}

TEST_F(SurfaceQuestionsTest, two_votes_decide_that_it_moves) {
  EXPECT_EQ(on_thing(frame(SurfaceVote::kMoves).open), all_);
  const UndecidedSurfaces decided = frame(SurfaceVote::kMoves);
  EXPECT_EQ(on_thing(decided.moving), all_);
  EXPECT_EQ(on_thing(decided.open), 0);
}

TEST_F(SurfaceQuestionsTest, what_rests_is_not_asked_again) {
  frame(SurfaceVote::kRests);
  EXPECT_EQ(on_thing(frame(SurfaceVote::kRests).open), 0);
  for (int i = 0; i < 3; ++i) {
    const UndecidedSurfaces later = frame(SurfaceVote::kMoves);
    EXPECT_EQ(on_thing(later.open), 0);
    EXPECT_EQ(on_thing(later.moving), 0) << "from now on the views decide";
  }
}

TEST_F(SurfaceQuestionsTest, opposite_votes_cancel) {
  frame(SurfaceVote::kMoves);
  frame(SurfaceVote::kRests);
  EXPECT_EQ(on_thing(frame(SurfaceVote::kMoves).open), all_);
  EXPECT_EQ(on_thing(frame(SurfaceVote::kMoves).moving), all_);
}

TEST_F(SurfaceQuestionsTest, are_forgotten_with_a_new_start) {
  frame(SurfaceVote::kMoves);
  decisions_.clear();
  EXPECT_EQ(on_thing(frame(SurfaceVote::kMoves).open), all_);
}

}  // namespace
}  // namespace rtd::filter
