// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/mover_tracks.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/filter/grid_scenes.hpp"

namespace rtd::filter {
namespace {

using test::cells_in;
using test::count_in;
using test::kBlock;
using test::kShape;

const cv::Rect kEverywhere(0, 0, 640, 480);
constexpr double kStepS = 0.1;

/// A block at 1.5 m before a wall at 3 m, frame by frame of a tenth of a second.
class MoverTracksTest : public ::testing::Test {
 protected:
  static vision::RgbdImage block_at(const cv::Rect& area) {
    vision::RgbdImage image = test::wall_image(3.0);
    test::put_block(image, area, 1.5);
    return image;
  }
  /// The camera turns its back: another wall.
  static Eigen::Isometry3d looking_away() {
    return Eigen::Isometry3d(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()));
  }
  void step(const vision::RgbdImage& image, bool seen_moving,
            const Eigen::Isometry3d& T_world_camera = Eigen::Isometry3d::Identity(), const FeatureVotes& votes = {}) {
    const DepthGrid grid = sampler_.sample(image);
    CellMask moving(grid.depth_m.size(), 0);
    for (std::size_t i = 0; i < moving.size(); ++i) moving[i] = seen_moving && grid.depth_m[i] < 2 ? 1 : 0;
    stamp_ns_ += static_cast<std::int64_t>(1e9 * kStepS);
    tracks_.update({grid, sampler_.rays(), image.camera, {stamp_ns_, T_world_camera}},
                   find_depth_clusters(grid, ClusterConfig{}), moving, votes);
  }
  /// Seen moving for a second, at rest or to the right.
  void see_mover(int px_per_frame = 0) {
    for (int i = 0; i < 10; ++i) step(block_at(kBlock + cv::Point(i * px_per_frame, 0)), true);
  }
  void look_away(double for_s) {
    for (int i = 0; i < for_s / kStepS; ++i) step(test::wall_image(3.0), false, looking_away());
  }
  CellMask expected(const vision::RgbdImage& image) {
    const DepthGrid grid = sampler_.sample(image);
    return tracks_.expected({grid, sampler_.rays(), image.camera, {stamp_ns_, Eigen::Isometry3d::Identity()}});
  }
  /// Slow votes of a block at its place.
  static FeatureVotes resting() {
    FeatureVotes votes;
    for (int i = 0; i < 10; ++i) votes.votes.push_back({kShape.cell_at(250 + 10 * i, 240), false});
    return votes;
  }

  MoverTrackConfig config_;
  DepthGridSampler sampler_ = test::make_sampler();
  MoverTracks tracks_{config_};
  std::int64_t stamp_ns_ = 0;
};

TEST_F(MoverTracksTest, recognises_a_mover_that_returns_to_the_view) {
  see_mover();
  look_away(2);
  const CellMask mask = expected(block_at(kBlock));
  EXPECT_GT(count_in(kShape, mask, kBlock), cells_in(kBlock) * 9 / 10);
  EXPECT_EQ(count_in(kShape, mask, kEverywhere), count_in(kShape, mask, kBlock)) << "the wall behind it is the wall";
}

TEST_F(MoverTracksTest, leaves_what_stays_in_sight_to_the_memory) {
  see_mover();
  for (int i = 0; i < 20; ++i) step(block_at(kBlock), false);
  EXPECT_EQ(count_in(kShape, expected(block_at(kBlock)), kEverywhere), 0);
}

TEST_F(MoverTracksTest, leaves_the_first_second_to_the_memory) {
  see_mover();
  look_away(0.5);
  EXPECT_EQ(count_in(kShape, expected(block_at(kBlock)), kEverywhere), 0);
}

TEST_F(MoverTracksTest, keeps_one_identity_and_its_velocity) {
  see_mover(10);
  ASSERT_EQ(tracks_.movers().size(), 1U);
  const TrackedMover mover = tracks_.movers().front();
  const double true_m_s = 10 / kStepS * 1.5 / 525;
  EXPECT_NEAR(mover.velocity_world_m_s.x(), true_m_s, 0.2 * true_m_s);
  EXPECT_NEAR(mover.extent_world.center().z(), 1.5, 0.02);
  EXPECT_NEAR(mover.age_s, 0.9, 1e-9);
}

TEST_F(MoverTracksTest, ends_what_may_have_gone_too_far_or_too_long_ago) {
  see_mover(10);  // 0.29 m/s
  look_away(2);
  EXPECT_TRUE(tracks_.movers().empty());
  see_mover();
  look_away(config_.max_unseen_s + 0.2);
  EXPECT_TRUE(tracks_.movers().empty());
}

TEST_F(MoverTracksTest, ends_when_its_place_is_seen_without_it) {
  see_mover();
  for (int i = 0; i < 4; ++i) step(test::wall_image(3.0), false);
  EXPECT_EQ(tracks_.movers().size(), 1U) << "a moment is nothing";
  for (int i = 0; i < 3; ++i) step(test::wall_image(3.0), false);
  EXPECT_TRUE(tracks_.movers().empty());
}

TEST_F(MoverTracksTest, keeps_what_has_no_depth_for_a_while) {
  see_mover();
  vision::RgbdImage hole = block_at(kBlock);
  test::put_block(hole, kBlock, 0);
  for (int i = 0; i < 20; ++i) step(hole, false);
  EXPECT_GT(count_in(kShape, expected(block_at(kBlock)), kBlock), cells_in(kBlock) * 9 / 10);
}

TEST_F(MoverTracksTest, ends_when_it_was_seen_at_rest) {
  see_mover();
  for (int i = 0; i < 30; ++i) step(block_at(kBlock), false);
  EXPECT_EQ(tracks_.movers().size(), 1U) << "nothing has shown that it rests";
  for (int i = 0; i < 16; ++i) step(block_at(kBlock), false, Eigen::Isometry3d::Identity(), resting());
  EXPECT_TRUE(tracks_.movers().empty());
}

TEST_F(MoverTracksTest, does_not_take_a_jump_of_the_centre_for_motion_when_two_movers_part) {
  const cv::Rect pair(240, 160, 240, 160);
  for (int i = 0; i < 10; ++i) step(block_at(pair), true);
  for (int i = 0; i < 5; ++i) step(block_at(kBlock), true);
  EXPECT_LT(tracks_.movers().front().velocity_world_m_s.norm(), 0.05);
}

TEST_F(MoverTracksTest, does_not_report_a_mover_that_was_seen_once_or_twice) {
  for (int i = 0; i < 2; ++i) step(block_at(kBlock), true);
  EXPECT_TRUE(tracks_.movers().empty());
}

TEST_F(MoverTracksTest, bounds_the_number_of_tracks) {
  for (int frame = 0; frame < 6; ++frame) {
    vision::RgbdImage image = test::wall_image(3.0);
    for (int i = 0; i < 48; ++i) test::put_block(image, {8 + 80 * (i % 8), 4 + 80 * (i / 8), 56, 56}, 1.0 + 0.02 * i);
    step(image, true);
  }
  EXPECT_LE(tracks_.movers().size(), MoverTracks::kMaxTracks);
}

}  // namespace
}  // namespace rtd::filter
