// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

#include "common/geometry/se3.hpp"
#include "services/slam/core/map/local_map.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "services/slam/core/tracking/pose_ransac.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;

Eigen::Isometry3d shifted(double x_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
}

/// A share of the points has depth, the same ones in all views.
FramePtr view(const FeatureWorld& world, std::uint64_t seq, const Eigen::Isometry3d& T_world_camera,
              double depth_share) {
  auto message = world.view(seq, T_world_camera);
  for (msg::Feature& feature : message->features) {
    if (static_cast<double>(feature.descriptor[0] % 100) >= 100 * depth_share) feature.depth_m = 0;
  }
  return make_frame(*message, {}).frame;
}

FeatureWorld make_world() {
  FeatureWorld::Options options;
  options.points = 700;
  return FeatureWorld(options);
}

TEST(Triangulate, finds_the_point_that_two_rays_meet_in) {
  const Eigen::Vector3d p_world(0.3, -0.2, 2.5);
  const Eigen::Isometry3d T_1 = geometry::se3_exp((geometry::Vector6d() << 0.1, 0, 0, 0, 0.1, 0).finished());
  const Eigen::Isometry3d T_2 = geometry::se3_exp((geometry::Vector6d() << -0.2, 0.1, 0, 0.1, 0, 0.2).finished());
  const auto p = triangulate(T_1, (T_1 * p_world).hnormalized(), T_2, (T_2 * p_world).hnormalized());
  ASSERT_TRUE(p);
  EXPECT_LT((*p - p_world).norm(), 1e-9);
}

TEST(Triangulate, gives_no_point_for_parallel_rays) {
  EXPECT_FALSE(triangulate(shifted(0), {0.1, 0.1}, shifted(-0.2), {0.1, 0.1}));
}

TEST(LandmarkCreation, takes_close_depth_and_at_least_the_nearest_hundred) {
  const FramePtr frame = view(make_world(), 0, shifted(0), 1.0);
  const std::vector<LandmarkId> none(frame->features.size(), kNoLandmark);
  EXPECT_EQ(select_close_features(*frame, none, 100.0).size(), frame->features.size());
  const auto nearest = select_close_features(*frame, none, 0.1);
  EXPECT_EQ(nearest.size(), 100U);
  std::vector<LandmarkId> all_known(frame->features.size(), 7);
  EXPECT_TRUE(select_close_features(*frame, all_known, 100.0).empty());
}

TEST(LandmarkCreation, puts_points_where_they_are) {
  Map map;
  const FeatureWorld world = make_world();
  const Eigen::Isometry3d T_world_camera = shifted(0.2);
  map.add_keyframe(view(world, 0, T_world_camera, 1.0), T_world_camera, kNoKeyframe);
  const auto created = create_from_depth(map, 0, 10.0);
  EXPECT_EQ(created.size(), map.find_keyframe(0)->frame->features.size());
  EXPECT_EQ(map.check_invariants(), "");
  const Landmark& landmark = *map.find_landmark(created.front());
  const Eigen::Vector3d p_camera = T_world_camera.inverse() * landmark.position;
  const auto measured = map.find_keyframe(0)->frame->measurement(landmark.observations.front().feature);
  EXPECT_LT(vision::rgbd_residual(map.find_keyframe(0)->frame->camera, p_camera, measured).norm(), 1e-6);
}

TEST(LandmarkCreation, takes_what_is_beyond_the_range_of_the_sensor_to_be_there) {
  const FeatureWorld world = make_world();
  auto message = world.view(0, shifted(0));
  for (msg::Feature& feature : message->features) {
    if (feature.v_px < 320) feature.depth_m = 0;
  }
  Map map;
  map.add_keyframe(make_frame(*message, {}).frame, shifted(0), kNoKeyframe);
  const Frame& frame = *map.find_keyframe(0)->frame;
  const auto created = create_beyond_range(map, 0);
  EXPECT_GT(created.size(), 50U);
  for (const LandmarkId id : created) {
    const Landmark& landmark = *map.find_landmark(id);
    EXPECT_LT(frame.features[landmark.observations.front().feature].v_px, 320);
    EXPECT_GT(landmark.position.z(), 5) << "farther than all that was measured";
    EXPECT_FALSE(has_measured_depth(landmark));
  }
  const auto local = make_local_map(map, 0, 1, 10);
  const LocalLandmark& landmark = *local->find_landmark(created.front());
  EXPECT_DOUBLE_EQ(landmark.unmeasured.sigma_px(Eigen::Vector3d::Zero(), 500), 0) << "where it was seen";
  EXPECT_NEAR(landmark.unmeasured.sigma_px({0.1, 0, 0}, 500), 2.5, 1e-9);
  EXPECT_EQ(map.check_invariants(), "");
}

TEST(LandmarkCreation, does_not_take_holes_of_the_depth_image_for_far_away) {
  const FeatureWorld world = make_world();
  auto message = world.view(0, shifted(0));
  for (msg::Feature& feature : message->features) {
    if (feature.u_px < 200 && feature.v_px < 160) feature.depth_m = 0;
  }
  Map map;
  map.add_keyframe(make_frame(*message, {}).frame, shifted(0), kNoKeyframe);
  EXPECT_TRUE(create_beyond_range(map, 0).empty());
}

/// Two keyframes 0.3 m apart that share 40 landmarks where these are; the other features have none.
Map two_views(double depth_share_of_first, double depth_share_of_second) {
  Map map;
  const FeatureWorld world = make_world();
  const FramePtr true_depths = view(world, 0, shifted(0), 1.0);
  map.add_keyframe(view(world, 0, shifted(0), depth_share_of_first), shifted(0), kNoKeyframe);
  map.add_keyframe(view(world, 1, shifted(0.3), depth_share_of_second), shifted(0.3), 0);
  const Frame &first = *map.find_keyframe(0)->frame, &second = *map.find_keyframe(1)->frame;
  int shared = 0;
  for (std::uint32_t i = 0; i < first.features.size() && shared < 40; ++i) {
    for (std::uint32_t j = 0; j < second.features.size(); ++j) {
      if (first.features[i].descriptor != second.features[j].descriptor) continue;
      const LandmarkId id = map.add_landmark(true_depths->unproject(i), {0, i});
      map.add_observation(id, {1, j});
      map.refresh_landmark(id);
      ++shared;
    }
  }
  return map;
}

TEST(LandmarkCreation, triangulates_what_two_views_agree_on) {
  Map map = two_views(1.0, 0.0);
  const auto created = create_by_triangulation(map, 1, 10, 4.0);
  EXPECT_GT(created.size(), 60U);
  EXPECT_EQ(map.check_invariants(), "");
  for (const LandmarkId id : created) {
    const Landmark& landmark = *map.find_landmark(id);
    ASSERT_EQ(landmark.observations.size(), 2U);
    const Frame &first = *map.find_keyframe(0)->frame, &second = *map.find_keyframe(1)->frame;
    const std::uint32_t i = landmark.observations[0].feature, j = landmark.observations[1].feature;
    EXPECT_EQ(first.features[i].descriptor, second.features[j].descriptor);
    EXPECT_LT((landmark.position - first.unproject(i)).norm(), 2e-3);  // m
  }
}

TEST(LandmarkCreation, makes_nothing_of_views_from_the_same_place) {
  Map map = two_views(1.0, 0.0);
  map.find_keyframe(1)->T_world_camera = shifted(0.01);
  EXPECT_TRUE(create_by_triangulation(map, 1, 10, 4.0).empty());
}

/// Landmarks that no view measured the depth of, with their depth in the first camera, which is the world.
std::vector<double> depths_without_measurement(const Map& map, const std::vector<LandmarkId>& landmarks) {
  std::vector<double> depths_m;
  for (const LandmarkId id : landmarks) {
    const Landmark& landmark = *map.find_landmark(id);
    const bool measured = std::ranges::any_of(landmark.observations, [&](const Observation& seen) {
      return map.find_keyframe(seen.keyframe)->frame->features[seen.feature].depth_m > 0;
    });
    if (!measured) depths_m.push_back(landmark.position.z());
  }
  return depths_m;
}

TEST(LandmarkCreation, puts_nothing_into_the_close_range_where_a_depth_sensor_saw_nothing) {
  constexpr double kCloseDepth_m = 3.0;
  Map map = two_views(0.5, 0.5);
  const auto depths_m = depths_without_measurement(map, create_by_triangulation(map, 1, 10, kCloseDepth_m));
  EXPECT_GT(depths_m.size(), 20U) << "what is far needs no depth";
  EXPECT_THAT(depths_m, ::testing::Each(::testing::Ge(kCloseDepth_m)));
}

TEST(LandmarkCreation, needs_no_depth_when_the_sensor_measures_none) {
  constexpr double kCloseDepth_m = 3.0;
  Map map = two_views(0.0, 0.0);
  const auto depths_m = depths_without_measurement(map, create_by_triangulation(map, 1, 10, kCloseDepth_m));
  EXPECT_THAT(depths_m, ::testing::Contains(::testing::Lt(kCloseDepth_m)));
}

TEST(LandmarkFusion, joins_two_landmarks_of_one_point) {
  Map map = two_views(1.0, 1.0);
  create_from_depth(map, 0, 10.0);
  create_from_depth(map, 1, 10.0);  // the same points once more
  const std::size_t before = map.landmark_count();
  const int merged = fuse_landmarks(map, 1, 10);
  EXPECT_GT(merged, 60);
  EXPECT_EQ(map.landmark_count(), before - static_cast<std::size_t>(merged));
  EXPECT_EQ(map.check_invariants(), "");
  for (const LandmarkId id : map.landmark_ids()) {
    const Landmark& landmark = *map.find_landmark(id);
    if (landmark.observations.size() < 2) continue;
    EXPECT_EQ(map.find_keyframe(0)->frame->features[landmark.observations[0].feature].descriptor,
              map.find_keyframe(1)->frame->features[landmark.observations[1].feature].descriptor);
  }
}

TEST(Culling, removes_landmarks_that_are_rarely_found) {
  Map map = two_views(1.0, 1.0);
  RecentLandmarks recent;
  recent.add(map.landmark_ids());
  map.find_landmark(0)->visible = 100;
  map.find_landmark(0)->found = 24;
  map.find_landmark(1)->visible = 100;
  map.find_landmark(1)->found = 26;
  EXPECT_EQ(recent.cull(map, 1, 0.25), 1);
  EXPECT_EQ(map.find_landmark(0), nullptr);
  EXPECT_NE(map.find_landmark(1), nullptr);
}

TEST(Culling, removes_unconfirmed_landmarks_and_ends_probation) {
  Map map = two_views(1.0, 1.0);
  const auto single = create_from_depth(map, 1, 10.0);
  RecentLandmarks recent;
  recent.add(map.landmark_ids());
  EXPECT_EQ(recent.cull(map, 2, 0.25), 0) << "one keyframe is too early to judge those of keyframe 1";
  EXPECT_EQ(recent.cull(map, 3, 0.25), static_cast<int>(single.size()));
  EXPECT_EQ(recent.size(), 0U) << "the others lasted three keyframes";
}

TEST(Culling, finds_keyframes_that_three_others_make_superfluous) {
  Map map;
  const FeatureWorld world = make_world();
  for (std::uint32_t k = 0; k < 5; ++k) {
    map.add_keyframe(view(world, k, shifted(0), 1.0), shifted(0), k == 0 ? kNoKeyframe : k - 1);
  }
  const std::size_t features = map.find_keyframe(0)->frame->features.size();
  for (std::uint32_t i = 0; i < features; ++i) {
    const LandmarkId id = map.add_landmark(map.find_keyframe(0)->frame->unproject(i), {0, i});
    for (KeyframeId k = 1; k < 4; ++k) map.add_observation(id, {k, i});
    if (i % 5 == 0) map.add_observation(id, {4, i});  // a fifth of what the others see, nothing else
  }
  EXPECT_TRUE(is_redundant_keyframe(map, 4, 0, {}));
  EXPECT_TRUE(is_redundant_keyframe(map, 2, 0, {})) << "0, 1 and 3 see all of it";
  EXPECT_FALSE(is_redundant_keyframe(map, 0, 0, {})) << "the first is never removed";
  map.remove_keyframe(2);
  EXPECT_FALSE(is_redundant_keyframe(map, 1, 0, {})) << "most of it is left with two others";
}

TEST(Culling, asks_less_of_old_keyframes) {
  Map map;
  const FeatureWorld world = make_world();
  for (std::uint32_t k = 0; k < 4; ++k)
    map.add_keyframe(view(world, k, shifted(0), 1.0), shifted(0), k == 0 ? kNoKeyframe : k - 1);
  const std::size_t features = map.find_keyframe(1)->frame->features.size();
  for (std::uint32_t i = 0; i < features; ++i) {
    const LandmarkId id = map.add_landmark(map.find_keyframe(1)->frame->unproject(i), {1, i});
    if (i % 4 == 0) continue;  // a quarter is seen by keyframe 1 alone
    for (const KeyframeId other : {0, 2, 3}) map.add_observation(id, {other, i});
  }
  const MapperConfig config;
  const std::int64_t then_ns = map.find_keyframe(1)->frame->stamp_ns;
  const auto after_ns = [&](double seconds) { return then_ns + static_cast<std::int64_t>(1e9 * seconds); };
  EXPECT_FALSE(is_redundant_keyframe(map, 1, after_ns(config.old_after_s - 1), config));
  EXPECT_TRUE(is_redundant_keyframe(map, 1, after_ns(config.old_after_s + 1), config));
  EXPECT_FALSE(is_redundant_keyframe(map, 1, after_ns(-1000), config)) << "of a map that another clock made";
}

const Eigen::Isometry3d kFarPose =
    geometry::se3_exp((geometry::Vector6d() << 0.5, 0.2, -0.3, 0.2, 0.6, -0.1).finished());

/// What a frame at kFarPose sees; 60 % are wrong.
std::vector<vision::PoseObservation> observe_with_outliers(const Frame& frame) {
  std::vector<vision::PoseObservation> observations;
  for (std::size_t i = 0; i < frame.features.size(); ++i) {
    vision::PoseObservation observation{kFarPose * frame.unproject(i), frame.measurement(i), 1.0, 1.0};
    if (i % 5 < 3) observation.p_world += Eigen::Vector3d(1 + 0.01 * static_cast<double>(i), -0.5, 0.3);
    observations.push_back(observation);
  }
  return observations;
}

TEST(PoseRansac, finds_the_pose_among_outliers) {
  const FramePtr frame = view(make_world(), 0, kFarPose, 1.0);
  const auto observations = observe_with_outliers(*frame);
  const auto result = estimate_pose_ransac(frame->camera, observations, {});
  ASSERT_TRUE(result.success);
  EXPECT_LT((result.T_world_camera.inverse() * kFarPose).translation().norm(), 1e-3);
  EXPECT_GE(result.inliers, static_cast<int>(observations.size()) * 2 / 5 - 1);
}

TEST(PoseRansac, needs_no_depth_at_all) {
  const FramePtr frame = view(make_world(), 0, kFarPose, 1.0);
  auto observations = observe_with_outliers(*frame);
  for (vision::PoseObservation& observation : observations) observation.measured.depth_m = 0;
  const auto result = estimate_pose_ransac(frame->camera, observations, {});
  ASSERT_TRUE(result.success);
  EXPECT_LT((result.T_world_camera.inverse() * kFarPose).translation().norm(), 1e-3);
}

TEST(PoseRansac, fails_with_two_points_or_without_agreement) {
  const FramePtr frame = view(make_world(), 0, shifted(0), 1.0);
  std::vector<vision::PoseObservation> observations;
  for (std::size_t i = 0; i < frame->features.size(); ++i) {
    const auto x = static_cast<double>(i);
    observations.push_back({{std::sin(7 * x), std::cos(3 * x), 2 + std::sin(11 * x)}, frame->measurement(i), 1.0, 1.0});
  }
  EXPECT_FALSE(estimate_pose_ransac(frame->camera, observations, {}).success);
  observations.resize(2);
  EXPECT_FALSE(estimate_pose_ransac(frame->camera, observations, {}).success);
}

}  // namespace
}  // namespace rtd::slam
