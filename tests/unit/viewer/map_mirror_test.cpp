// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/map_mirror.hpp"

#include <gmock/gmock.h>
#include <malloc.h>

#include "common/msg/transform_eigen.hpp"
#include "services/viewer/core/robot_mirror.hpp"
#include "tests/support/sanitizers.hpp"

namespace rtd::viewer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

msg::MapKeyframe keyframe(std::uint32_t id, double x, std::uint32_t content = 0, std::vector<float> points = {}) {
  msg::MapKeyframe entry;
  entry.keyframe_id = id;
  entry.T_world_camera = msg::to_message(Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)));
  entry.content = content;
  entry.points_m = std::move(points);
  return entry;
}

msg::MapUpdate update(std::vector<msg::MapKeyframe> keyframes, std::int64_t session = 1) {
  return {.session_ns = session, .revision = 1, .keyframes = std::move(keyframes)};
}

std::vector<std::uint32_t> after(const ChangeLog<std::uint32_t>& log, std::uint64_t revision) {
  std::vector<std::uint32_t> keys;
  log.after(revision, [&](std::uint32_t key, std::uint64_t) {
    keys.push_back(key);
    return true;
  });
  return keys;
}

TEST(ChangeLog, a_follower_gets_each_changed_key_once) {
  ChangeLog<std::uint32_t> log;
  for (const std::uint32_t key : {1U, 2U, 3U, 1U}) log.touch(key);
  EXPECT_THAT(after(log, 0), ElementsAre(2U, 3U, 1U));
  const std::uint64_t known = log.newest();
  log.touch(2);
  EXPECT_THAT(after(log, known), ElementsAre(2U));
  log.clear();
  log.touch(5);
  EXPECT_THAT(after(log, known), ElementsAre(5U)) << "revisions continue";
}

TEST(MapMirror, a_moved_keyframe_takes_its_points_along_without_sending_them) {
  MapMirror mirror;
  mirror.add(update({keyframe(1, 0, msg::kMapPoints, {1, 2, 3, 4, 5, 6}), keyframe(2, 1)}));
  EXPECT_EQ(mirror.point_count(), 2U);
  const std::uint64_t points = mirror.points().newest(), poses = mirror.poses().newest();
  mirror.add(update({keyframe(1, 0.5)}));
  EXPECT_THAT(after(mirror.poses(), poses), ElementsAre(1U));
  EXPECT_THAT(after(mirror.points(), points), IsEmpty());
  mirror.add(update({keyframe(1, 0.5)}));
  EXPECT_THAT(after(mirror.poses(), poses), ElementsAre(1U)) << "nothing has moved";
}

TEST(MapMirror, a_removed_keyframe_loses_its_points) {
  MapMirror mirror;
  mirror.add(update({keyframe(1, 0, msg::kMapPoints, {1, 2, 3})}));
  mirror.add(update({keyframe(1, 0, msg::kMapRemoved)}));
  EXPECT_EQ(mirror.point_count(), 0U);
  EXPECT_TRUE(mirror.keyframe(1).removed);
  mirror.add(update({keyframe(9, 0, msg::kMapRemoved)}));
  EXPECT_EQ(mirror.keyframes().size(), 1U);
}

msg::TrackingResult result(std::uint32_t map_id, const Eigen::Vector3d& position_m) {
  msg::TrackingResult result{};
  result.map_id = map_id;
  result.state = msg::TrackingState::kOk;
  Eigen::Map<Eigen::Vector3d>(result.T_world_camera.translation_m.data()) = position_m;
  result.covariance[7] = 0.04;
  return result;
}

TEST(MapMirror, another_session_forgets_everything) {
  MapMirror mirror;
  mirror.add(update({keyframe(1, 0)}));
  mirror.add_position(result(0, {0, 0, 0}));
  const std::uint64_t epoch = mirror.epoch();
  mirror.add(update({keyframe(2, 0)}, 2));
  EXPECT_NE(mirror.epoch(), epoch);
  EXPECT_EQ(mirror.keyframes().size(), 1U);
  EXPECT_THAT(mirror.trajectory(), IsEmpty());
}

TEST(MapMirror, a_restarted_slam_counts_its_events_from_zero) {
  MapMirror mirror;
  msg::KeyframeEvent event{.event_index = 7, .T_world_camera = keyframe(3, 1).T_world_camera, .keyframe_id = 3};
  mirror.add(event);
  const std::uint64_t epoch = mirror.epoch();
  event.event_index = 0;
  mirror.add(event);
  EXPECT_NE(mirror.epoch(), epoch);
}

TEST(MapMirror, the_trajectory_moves_with_its_keyframes) {
  MapMirror mirror;
  mirror.add_position(result(0, {5, 0, 0}));
  mirror.add(update({keyframe(1, 1)}));
  mirror.add_position(result(0, {1.5, 0, 0}));
  mirror.add_position(result(3, {9, 9, 9}));
  ASSERT_EQ(mirror.trajectory().size(), 2U);
  EXPECT_EQ(mirror.trajectory()[0].keyframe, TrajectoryPoint::kNone);
  EXPECT_EQ(mirror.trajectory()[1].keyframe, 1U);
  EXPECT_NEAR(mirror.trajectory()[1].position_m.x(), 0.5, 1e-6);
  EXPECT_NEAR(mirror.trajectory()[1].sigma_m, 0.2, 1e-6);
}

TEST(MapMirror, values_that_are_not_finite_are_left_out) {
  MapMirror mirror;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  mirror.add(update({keyframe(1, std::numeric_limits<double>::infinity()),
                     keyframe(2, 0, msg::kMapPoints, {kNan, 0, 0, 1, 1, 1, 7})}));
  EXPECT_FALSE(mirror.keyframes().contains(1));
  EXPECT_EQ(mirror.point_count(), 1U);
}

TEST(TruthTrack, is_aligned_to_the_estimate_and_gives_its_error) {
  TruthTrack track;
  const Eigen::Isometry3d T_map_truth =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d truth(std::sin(0.1 * i), std::cos(0.17 * i), 0.05 * i);
    const Eigen::Vector3d noise(0, i % 2 == 0 ? 0.01 : -0.01, 0);
    track.add_estimate(i, T_map_truth * truth + noise);
    track.add_truth(i, truth);
  }
  track.add_truth(1000, {0, 0, 0});
  track.align_if_grown();
  EXPECT_EQ(track.pairs(), 50U);
  EXPECT_NEAR(track.ate_m(), 0.01, 0.001);
  EXPECT_LT((track.aligned(3) - T_map_truth * track.positions_m()[3]).norm(), 0.005);
  EXPECT_EQ(track.revision(), 1U);
  EXPECT_NEAR(track.error_m(7).value_or(0), 0.01, 0.005);
  EXPECT_FALSE(track.error_m(1000).has_value()) << "no pose";
  track.align_if_grown();
  EXPECT_EQ(track.revision(), 1U);
}

TEST(MapMirror, what_does_not_fit_is_left_out_and_counted) {
  MapMirror mirror({.keyframes = 2, .points = 3, .edges = 2, .trajectory = 1});
  msg::MapKeyframe first = keyframe(1, 0, msg::kMapPoints | msg::kMapEdges, {1, 2, 3, 4, 5, 6});
  first.covisible = {5, 6, 7};
  mirror.add(update({first, keyframe(2, 1, msg::kMapPoints, {1, 2, 3, 4, 5, 6}), keyframe(3, 2)}));
  EXPECT_EQ(mirror.keyframes().size(), 2U);
  EXPECT_EQ(mirror.point_count(), 3U);
  EXPECT_THAT(mirror.keyframe(1).covisible, ElementsAre(5U, 6U));
  for (int i = 0; i < 2; ++i) mirror.add_position(result(0, {1, 2, 3}));
  EXPECT_EQ(mirror.trajectory().size(), 1U);
  EXPECT_EQ(mirror.left_out(), 4U) << "a keyframe, a point, an edge, a position";
  msg::MapKeyframe gone = keyframe(1, 0, msg::kMapRemoved);
  mirror.add(update({gone, keyframe(2, 1, msg::kMapPoints, {1, 2, 3, 4, 5, 6})}));
  EXPECT_EQ(mirror.point_count(), 2U) << "a removed keyframe makes room";
}

TEST(MapMirror, memory_stays_below_64_mb_whatever_updates_claim) {
  if (test_support::kSanitized) GTEST_SKIP() << "sanitizers count their own memory";
  const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  MapMirror mirror;
  std::uint32_t id = 0;
  for (int message = 0; message < 1000; ++message) {
    std::vector<msg::MapKeyframe> forged;
    for (int i = 0; i < 100; ++i) {
      forged.push_back(keyframe(id++, message, msg::kMapPoints | msg::kMapEdges, std::vector<float>(600, 1.0F)));
      forged.back().covisible.assign(100, id);
    }
    mirror.add(update(std::move(forged)));
  }
  EXPECT_LT(mallinfo2().uordblks + mallinfo2().hblkhd, before + 64'000'000);
  EXPECT_GT(mirror.left_out(), 0U);
}

}  // namespace
}  // namespace rtd::viewer
