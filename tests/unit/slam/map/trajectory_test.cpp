// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/trajectory.hpp"

#include <gmock/gmock.h>

#include <sstream>

namespace rtd::slam {
namespace {

Eigen::Isometry3d at_x(double x_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
}

TEST(ComposeTrajectory, follows_corrected_and_removed_keyframes) {
  Map map;
  for (KeyframeId k = 0; k < 3; ++k) {
    auto frame = std::make_shared<Frame>();
    frame->stamp_ns = 100 * k;
    map.add_keyframe(frame, at_x(k), k == 0 ? kNoKeyframe : k - 1);
  }
  const std::vector<FrameRecord> frames{{5, 50, 0, at_x(0.5)}, {15, 150, 1, at_x(0.5)}};
  map.remove_keyframe(1);
  map.find_keyframe(0)->T_world_camera = at_x(10);
  const auto poses = compose_trajectory(map, frames);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].stamp_ns, 150);
  EXPECT_NEAR(poses[0].T_world_body.translation().x(), 10.5, 1e-12);
  EXPECT_NEAR(poses[1].T_world_body.translation().x(), 11.5, 1e-12);
  const auto keyframes = keyframe_trajectory(map);
  ASSERT_EQ(keyframes.size(), 2U);
  EXPECT_EQ(keyframes[1].stamp_ns, 200);
}

TEST(TieToLiving, leaves_the_poses_where_they_are) {
  Map map;
  for (KeyframeId k = 0; k < 4; ++k) {
    map.add_keyframe(std::make_shared<Frame>(), at_x(k), k == 0 ? kNoKeyframe : k - 1);
  }
  std::vector<FrameRecord> frames{{0, 0, 1, at_x(0.5)}, {1, 1, 2, at_x(0.25)}, {2, 2, 3, at_x(0.1)}};
  map.remove_keyframe(1);
  map.remove_keyframe(2);
  const auto before = compose_trajectory(map, frames);
  tie_to_living(frames, map);
  map.forget_removed(0);
  const auto after = compose_trajectory(map, frames);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_TRUE(after[i].T_world_body.isApprox(before[i].T_world_body, 1e-12)) << "frame " << i;
  }
  EXPECT_EQ(frames[0].reference, 0U);
  EXPECT_EQ(frames[2].reference, 3U);
}

TEST(ThinOut, keeps_the_last_half_and_ever_less_of_what_was_before) {
  constexpr std::size_t kLimit = 1000;
  std::vector<FrameRecord> frames;
  for (std::uint64_t seq = 0; seq < 20 * kLimit; ++seq) {
    thin_out(frames, kLimit);
    ASSERT_LT(frames.size(), kLimit);
    frames.push_back({seq});
  }
  const std::uint64_t newest = frames.back().seq;
  EXPECT_EQ(newest, 20 * kLimit - 1);
  EXPECT_EQ(frames[frames.size() - kLimit / 4].seq, newest + 1 - kLimit / 4) << "without a gap";
  EXPECT_EQ(frames.front().seq, 0U);
  EXPECT_GT(frames.size(), kLimit / 2);
  for (std::size_t i = 1; i < frames.size(); ++i) ASSERT_LT(frames[i - 1].seq, frames[i].seq);
}

TEST(Ply, counts_its_vertices) {
  std::ostringstream out;
  write_ply(out, {{{1, 2, 3}, 0.5F}, {{-1, 0, 4}, 1.0F}});
  EXPECT_THAT(out.str(), ::testing::StartsWith("ply\nformat ascii 1.0\n"));
  EXPECT_THAT(out.str(), ::testing::HasSubstr("element vertex 2\n"));
  EXPECT_THAT(out.str(),
              ::testing::HasSubstr("end_header\n1.00000 2.00000 3.00000 0.500\n-1.00000 0.00000 4.00000 1.000\n"));
}

}  // namespace
}  // namespace rtd::slam
