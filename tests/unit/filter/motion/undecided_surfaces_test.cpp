// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/undecided_surfaces.hpp"

#include <gtest/gtest.h>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kShape;

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
