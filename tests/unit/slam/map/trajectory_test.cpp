// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/trajectory.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
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

/// A camera carried by hand for two seconds; from 0.7 to 1.3 s it follows a person who walks past: 0.4 m/s aside.
class MendDoubtful : public ::testing::Test {
 protected:
  MendDoubtful() : doubtful_(kCount, false) {
    for (std::size_t i = 0; i < kCount; ++i) truth_.push_back({static_cast<std::int64_t>(i) * kPeriod_ns, pose_at(i)});
    poses_ = truth_;
  }

  static Eigen::Isometry3d pose_at(std::size_t i) {
    const double t = 1e-9 * static_cast<double>(kPeriod_ns) * static_cast<double>(i);
    Eigen::Isometry3d pose(Eigen::AngleAxisd(0.3 * std::sin(2 * t), Eigen::Vector3d::UnitY()));
    pose.translation() = Eigen::Vector3d(0.2 * std::sin(2 * t), 0.1 * std::cos(1.5 * t), 0.3 * t);
    return pose;
  }

  /// The last `right` of the doubtful poses are where the camera is.
  void follow_a_person(std::size_t right = 0) {
    for (std::size_t i = kFrom; i < kTo; ++i) {
      doubtful_[i] = true;
      const double away_s = 1e-9 * static_cast<double>(kPeriod_ns) * static_cast<double>(i - kFrom + 1);
      if (i + right < kTo) poses_[i].T_world_body = Eigen::Translation3d(0.4 * away_s, 0, 0) * poses_[i].T_world_body;
    }
  }

  double worst_m() const {
    double worst = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      worst = std::max(worst, (poses_[i].T_world_body.translation() - truth_[i].T_world_body.translation()).norm());
    }
    return worst;
  }

  static constexpr std::int64_t kPeriod_ns = 33'333'333;
  static constexpr std::size_t kCount = 60, kFrom = 21, kTo = 39;
  std::vector<StampedPose> truth_, poses_;
  std::vector<bool> doubtful_;
};

TEST_F(MendDoubtful, brings_a_camera_back_that_followed_a_person) {
  follow_a_person();
  const auto before = poses_;
  ASSERT_GT(worst_m(), 0.2);
  mend_doubtful(poses_, doubtful_);
  EXPECT_LT(worst_m(), 0.04);
  for (std::size_t i = 0; i < kCount; ++i) {
    if (!doubtful_[i]) {
      EXPECT_EQ(poses_[i].T_world_body.matrix(), before[i].T_world_body.matrix()) << "frame " << i;
    }
    EXPECT_LT(geometry::rotation_angle_rad(poses_[i].T_world_body.inverse() * truth_[i].T_world_body), 0.02);
  }
}

TEST_F(MendDoubtful, keeps_doubtful_poses_that_fit) {
  follow_a_person(kTo - kFrom);
  mend_doubtful(poses_, doubtful_);
  EXPECT_LT(worst_m(), 0.002);
}

TEST_F(MendDoubtful, turns_back_what_was_turned) {
  for (std::size_t i = kFrom; i < kTo; ++i) {
    doubtful_[i] = true;
    const double turned_rad = i < (kFrom + kTo) / 2 ? 0.2 : 0.0;
    poses_[i].T_world_body.linear() =
        Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()) * poses_[i].T_world_body.linear();
  }
  mend_doubtful(poses_, doubtful_);
  for (std::size_t i = kFrom; i < kTo; ++i) {
    EXPECT_LT(geometry::rotation_angle_rad(poses_[i].T_world_body.inverse() * truth_[i].T_world_body), 0.05);
  }
}

TEST_F(MendDoubtful, leaves_what_has_one_end_only_or_a_gap) {
  follow_a_person();
  const auto unchanged = [this] {
    auto mended = poses_;
    mend_doubtful(mended, doubtful_);
    for (std::size_t i = 0; i < mended.size(); ++i) {
      if (mended[i].T_world_body.matrix() != poses_[i].T_world_body.matrix()) return false;
    }
    return true;
  };
  EXPECT_FALSE(unchanged());
  const std::vector<bool> around = doubtful_;
  std::fill(doubtful_.begin(), doubtful_.begin() + kFrom, true);
  EXPECT_TRUE(unchanged()) << "the start";
  doubtful_ = around;
  std::fill(doubtful_.begin() + kTo, doubtful_.end(), true);
  EXPECT_TRUE(unchanged()) << "the end";
  doubtful_ = around;
  for (std::size_t i = kTo; i < kCount; ++i) poses_[i].stamp_ns += 1'000'000'000;
  EXPECT_TRUE(unchanged()) << "a second without a pose";
  for (std::size_t i = kTo; i < kCount; ++i) poses_[i].stamp_ns -= 3'000'000'000;
  EXPECT_TRUE(unchanged()) << "time that goes back";
}

TEST(ComposeTrajectory, mends_what_was_in_doubt) {
  Map map;
  map.add_keyframe(std::make_shared<Frame>(), at_x(0), kNoKeyframe);
  std::vector<FrameRecord> frames;
  for (std::uint64_t i = 0; i < 9; ++i) {
    const bool doubtful = i == 4;
    frames.push_back({i, static_cast<std::int64_t>(i) * 33'000'000, 0, at_x(doubtful ? 0.3 : 0), doubtful});
  }
  EXPECT_NEAR(compose_trajectory(map, frames)[4].T_world_body.translation().x(), 0, 0.02);
  frames[4].doubtful = false;
  EXPECT_NEAR(compose_trajectory(map, frames)[4].T_world_body.translation().x(), 0.3, 1e-12);
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
