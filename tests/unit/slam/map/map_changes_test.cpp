// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/map_changes.hpp"

#include <gmock/gmock.h>

#include <set>

namespace rtd::slam {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

FramePtr make_plain_frame(std::size_t features) {
  auto frame = std::make_shared<Frame>();
  frame->features.resize(features);
  return frame;
}

Eigen::Isometry3d standing_at(double x_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
}

/// `count` keyframes in a row; keyframe k made `kOwn` landmarks, and the next one sees them too.
class RowOfKeyframes {
 public:
  static constexpr std::uint32_t kOwn = 60;

  explicit RowOfKeyframes(KeyframeId count) {
    for (KeyframeId k = 0; k < count; ++k) add();
  }
  KeyframeId add() {
    const KeyframeId k = map.next_keyframe();
    map.add_keyframe(make_plain_frame(2 * kOwn), standing_at(k), k == 0 ? kNoKeyframe : k - 1);
    for (std::uint32_t i = 0; i < kOwn; ++i) {
      const LandmarkId id = map.add_landmark({static_cast<double>(k), 0.01 * i, 2}, {k, i});
      if (k > 0) map.add_observation(id - kOwn, {k, kOwn + i});
    }
    return k;
  }
  MapView view() const {
    return copy_view([this](const auto& look) { look(map); });
  }
  /// As a closed loop does: keyframes and what belongs to them.
  void move_all(double x_m) {
    std::vector<KeyframeId> ids;
    for (const auto& [id, keyframe] : map.keyframes()) ids.push_back(id);
    for (const KeyframeId id : ids) map.find_keyframe(id)->T_world_camera.translation().x() += x_m;
    for (const LandmarkId id : map.landmark_ids()) map.find_landmark(id)->position.x() += x_m;
  }

  Map map;
};

std::size_t count_points(const MapView& view) {
  std::size_t points = 0;
  for (const KeyframeView& keyframe : view.keyframes) points += keyframe.points_m.size();
  return points;
}

TEST(MapView, gives_each_landmark_to_one_keyframe_in_its_camera_frame) {
  RowOfKeyframes row(700);  // more than one portion
  const MapView view = row.view();
  ASSERT_THAT(view.keyframes, SizeIs(700));
  EXPECT_EQ(count_points(view), row.map.landmark_count());
  EXPECT_EQ(view.keyframes[650].points_m[3], Eigen::Vector3f(0, 0.03F, 2));
  EXPECT_THAT(view.keyframes[650].covisible, ElementsAre(649)) << "each edge is the younger keyframe's";
  EXPECT_THAT(view.keyframes[0].covisible, IsEmpty());
}

TEST(MapView, names_loops_by_keyframes_that_are_still_there) {
  RowOfKeyframes row(5);
  row.map.add_loop({1, 4, Eigen::Isometry3d::Identity(), 50});
  EXPECT_THAT(row.view().loop_edges, ElementsAre(1, 4));
  row.map.remove_keyframe(1);
  EXPECT_THAT(row.view().loop_edges, ElementsAre(0, 4));
}

TEST(MapChanges, report_all_at_first_and_then_nothing_while_nothing_changes) {
  const RowOfKeyframes row(3);
  MapChanges changes;
  const MapNews first = changes.update(row.view());
  EXPECT_TRUE(first.new_session);
  ASSERT_THAT(first.keyframes, SizeIs(3));
  for (const KeyframeNews& news : first.keyframes) EXPECT_TRUE(news.points && news.edges && !news.removed);
  EXPECT_TRUE(changes.update(row.view()).empty());
}

TEST(MapChanges, a_new_keyframe_is_reported_alone) {
  RowOfKeyframes row(3);
  MapChanges changes;
  changes.update(row.view());
  row.add();
  const MapNews news = changes.update(row.view());
  ASSERT_THAT(news.keyframes, SizeIs(1));
  EXPECT_EQ(news.keyframes[0].id, 3U);
}

TEST(MapChanges, a_corrected_map_costs_poses_only) {
  RowOfKeyframes row(20);
  MapChanges changes;
  changes.update(row.view());
  row.move_all(0.4);
  const MapNews news = changes.update(row.view());
  ASSERT_THAT(news.keyframes, SizeIs(20));
  for (const KeyframeNews& one : news.keyframes) EXPECT_FALSE(one.points || one.edges || one.removed);
}

TEST(MapChanges, a_new_closed_loop_is_news) {
  RowOfKeyframes row(5);
  MapChanges changes;
  changes.update(row.view());
  row.map.add_loop({0, 4, Eigen::Isometry3d::Identity(), 50});
  const MapNews news = changes.update(row.view());
  EXPECT_TRUE(news.loops);
  EXPECT_THAT(news.keyframes, IsEmpty());
}

TEST(MapChanges, small_moves_wait_until_they_add_up) {
  RowOfKeyframes row(2);
  MapChanges changes;
  changes.update(row.view());
  row.map.find_landmark(5)->position.y() += 0.003;
  row.map.find_keyframe(1)->T_world_camera.translation().x() += 0.00006;
  EXPECT_TRUE(changes.update(row.view()).empty());
  row.map.find_landmark(5)->position.y() += 0.003;
  row.map.find_keyframe(1)->T_world_camera.translation().x() += 0.00006;
  const MapNews news = changes.update(row.view());
  ASSERT_THAT(news.keyframes, SizeIs(2));
  EXPECT_TRUE(news.keyframes[0].points) << "6 mm";
  EXPECT_FALSE(news.keyframes[1].points) << "0.12 mm: the pose";
}

TEST(MapChanges, refined_points_are_reported_in_turn_and_moved_ones_at_once) {
  RowOfKeyframes row(40);
  MapChanges changes;
  changes.update(row.view());
  for (const LandmarkId id : row.map.landmark_ids()) row.map.find_landmark(id)->position.y() += 0.01;
  std::set<KeyframeId> reported;
  for (int i = 0; i < 5; ++i) {
    const MapNews news = changes.update(row.view());
    ASSERT_THAT(news.keyframes, SizeIs(8));
    for (const KeyframeNews& one : news.keyframes) reported.insert(one.id);
  }
  EXPECT_THAT(reported, SizeIs(40));
  EXPECT_TRUE(changes.update(row.view()).empty());
  for (const LandmarkId id : row.map.landmark_ids()) row.map.find_landmark(id)->position.y() += 0.1;
  EXPECT_THAT(changes.update(row.view()).keyframes, SizeIs(40));
}

TEST(MapChanges, a_culled_keyframe_is_removed_and_another_one_gets_its_landmarks) {
  RowOfKeyframes row(4);
  MapChanges changes;
  changes.update(row.view());
  row.map.remove_keyframe(1);
  const MapView view = row.view();
  const MapNews news = changes.update(view);
  EXPECT_EQ(count_points(view), row.map.landmark_count());
  ASSERT_THAT(news.keyframes, SizeIs(2));
  EXPECT_TRUE(news.keyframes[0].id == 1 && news.keyframes[0].removed);
  EXPECT_TRUE(news.keyframes[1].id == 2 && news.keyframes[1].points && news.keyframes[1].edges);
}

TEST(MapChanges, another_map_is_a_new_session_without_removals) {
  const RowOfKeyframes row(4), other(2);
  MapChanges changes;
  changes.update(row.view());
  MapView view = other.view();
  view.session = 1;
  const MapNews news = changes.update(view);
  EXPECT_TRUE(news.new_session);
  ASSERT_THAT(news.keyframes, SizeIs(2));
  EXPECT_FALSE(news.keyframes[0].removed);
}

TEST(MapChanges, a_map_without_keyframes_is_news_when_it_replaces_another) {
  MapChanges changes;
  changes.update(RowOfKeyframes(2).view());
  MapView empty;
  empty.session = 1;
  EXPECT_FALSE(changes.update(empty).empty());
  EXPECT_TRUE(changes.update(empty).empty());
}

TEST(MapChanges, everything_is_reported_again_to_a_reader_that_comes_late) {
  RowOfKeyframes row(4);
  MapChanges changes;
  changes.update(row.view());
  row.map.remove_keyframe(1);
  const MapNews news = changes.update(row.view(), MapChanges::Extent::kEverything);
  EXPECT_FALSE(news.new_session);
  ASSERT_THAT(news.keyframes, SizeIs(4)) << "one is gone, for those that know it";
  EXPECT_TRUE(news.keyframes[0].removed);
  EXPECT_TRUE(news.keyframes[3].points && news.keyframes[3].edges);
  EXPECT_TRUE(changes.update(row.view()).empty());
}

}  // namespace
}  // namespace rtd::slam
