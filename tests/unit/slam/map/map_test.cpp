// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <random>

#include "common/geometry/se3.hpp"
#include "services/slam/core/map/facts.hpp"
#include "services/slam/core/map/map.hpp"

namespace rtd::slam {
namespace {

using ::testing::ElementsAre;

FramePtr make_test_frame(std::uint64_t seq, std::size_t features = 60) {
  auto frame = std::make_shared<Frame>();
  frame->seq = seq;
  frame->camera = {520, 520, 320, 240, 40};
  frame->width_px = 640;
  frame->height_px = 480;
  for (std::size_t i = 0; i < features; ++i) {
    msg::Feature feature{};
    feature.u_px = static_cast<float>(10 * i);
    feature.depth_m = i % 2 == 0 ? 2.0F : 0.0F;
    feature.static_probability = 0.5F;
    feature.descriptor.fill(static_cast<std::uint8_t>(i));
    frame->features.push_back(feature);
  }
  frame->grid = vision::FeatureGrid(frame->features, 640, 480);
  return frame;
}

Eigen::Isometry3d moved_right(double x_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0));
}

/// Three keyframes in a row; landmarks 0..39 seen by 0 and 1, 20..49 by 2 (landmark i is feature i everywhere).
Map make_map() {
  Map map;
  for (std::uint32_t k = 0; k < 3; ++k)
    map.add_keyframe(make_test_frame(10 * k), moved_right(0.1 * k), k == 0 ? kNoKeyframe : k - 1);
  for (std::uint32_t i = 0; i < 50; ++i) {
    const LandmarkId id = map.add_landmark({0.01 * i, 0, 2}, {i < 40 ? 0U : 2U, i});
    if (i < 40) map.add_observation(id, {1, i});
    if (i >= 20 && i < 40) map.add_observation(id, {2, i});
    map.refresh_landmark(id);
  }
  return map;
}

TEST(Map, counts_landmarks_in_common) {
  const Map map = make_map();
  EXPECT_EQ(map.check_invariants(), "");
  EXPECT_EQ(map.find_keyframe(0)->covisible.at(1), 40);
  EXPECT_EQ(map.find_keyframe(2)->covisible.at(1), 20);
  EXPECT_THAT(map.best_covisible(1, 5), ElementsAre(0, 2));
  EXPECT_THAT(map.best_covisible(2, 5, 21), ElementsAre());
}

TEST(Map, refuses_a_second_observation_of_feature_or_landmark) {
  Map map = make_map();
  EXPECT_FALSE(map.add_observation(0, {0, 55})) << "the keyframe sees this landmark already";
  EXPECT_FALSE(map.add_observation(0, {2, 30})) << "the feature belongs to another landmark";
  EXPECT_EQ(map.check_invariants(), "");
}

TEST(Map, last_observation_takes_the_landmark_with_it) {
  Map map = make_map();
  map.remove_observation(45, 2);
  EXPECT_EQ(map.find_landmark(45), nullptr);
  map.remove_observation(5, 0);
  ASSERT_NE(map.find_landmark(5), nullptr);
  EXPECT_EQ(map.find_landmark(5)->reference, 1U);
  EXPECT_EQ(map.check_invariants(), "");
}

TEST(Map, replacing_keeps_every_view_once) {
  Map map = make_map();
  const LandmarkId twin = map.add_landmark({0.05, 0, 2}, {2, 55});
  map.replace_landmark(twin, 5);
  EXPECT_EQ(map.find_landmark(twin), nullptr);
  EXPECT_EQ(map.find_landmark(5)->observations.size(), 3U);
  map.replace_landmark(30, 31);  // both seen by all three: 31 keeps its own
  EXPECT_EQ(map.find_keyframe(1)->landmarks[30], kNoLandmark);
  EXPECT_EQ(map.check_invariants(), "");
}

TEST(Map, removed_keyframe_stays_attached_to_its_parent) {
  Map map = make_map();
  map.remove_keyframe(1);
  EXPECT_EQ(map.check_invariants(), "");
  EXPECT_EQ(map.find_keyframe(2)->parent, 0U);
  map.find_keyframe(0)->T_world_camera = moved_right(5);
  EXPECT_NEAR(map.T_world_keyframe(1).translation().x(), 5.1, 1e-12);
}

TEST(Map, chain_of_removed_keyframes_follows_the_survivor) {
  Map map = make_map();
  map.add_keyframe(make_test_frame(30), moved_right(0.3), 2);
  map.remove_keyframe(2);
  map.remove_keyframe(1);
  map.find_keyframe(0)->T_world_camera = moved_right(-1);
  EXPECT_NEAR(map.T_world_keyframe(2).translation().x(), -0.8, 1e-12);
  EXPECT_EQ(map.find_keyframe(3)->parent, 0U);
}

TEST(Map, keyframe_without_parent_starts_a_component) {
  Map map = make_map();
  const KeyframeId origin = map.add_keyframe(make_test_frame(30), moved_right(9), kNoKeyframe);
  const KeyframeId second = map.add_keyframe(make_test_frame(40), moved_right(9.1), origin);
  EXPECT_EQ(map.find_keyframe(2)->map, 0U);
  EXPECT_EQ(map.find_keyframe(second)->map, 1U);
  EXPECT_TRUE(map.find_keyframe(origin)->is_origin());
  EXPECT_EQ(map.keyframe_count(0), 3U);
  EXPECT_EQ(map.keyframe_count(1), 2U);
  EXPECT_EQ(map.check_invariants(), "");
}

TEST(Map, joined_component_hangs_on_the_other) {
  Map map = make_map();
  const KeyframeId origin = map.add_keyframe(make_test_frame(30), moved_right(9), kNoKeyframe);
  map.add_keyframe(make_test_frame(40), moved_right(9.1), origin);
  map.join_components(1, 2);
  EXPECT_EQ(map.find_keyframe(origin)->parent, 2U);
  EXPECT_THAT(map.find_keyframe(2)->children, ElementsAre(origin));
  EXPECT_EQ(map.keyframe_count(0), 5U);
  EXPECT_EQ(map.keyframe_count(1), 0U);
  EXPECT_EQ(map.check_invariants(), "");
  map.remove_keyframe(origin);
  EXPECT_EQ(map.check_invariants(), "") << "no longer a first keyframe: it may be culled";
}

/// A keyframe with one feature, beside the one before.
void add_view(Map& map, const msg::Feature& feature) {
  auto frame = std::make_shared<Frame>();
  frame->features.push_back(feature);
  const auto k = static_cast<KeyframeId>(map.keyframes().size());
  map.add_keyframe(frame, moved_right(0.1 * k), k == 0 ? kNoKeyframe : k - 1);
}

TEST(Map, landmark_carries_mean_probability_and_typical_descriptor) {
  Map map;
  for (std::uint32_t k = 0; k < 3; ++k) {
    msg::Feature feature{};
    feature.static_probability = k == 0 ? 0.1F : 0.7F;
    feature.descriptor.fill(k == 1 ? 0xFF : 0x00);  // the second view is unlike the others
    feature.octave = 2;
    add_view(map, feature);
  }
  const LandmarkId id = map.add_landmark({0, 0, 2}, {1, 0});
  map.add_observation(id, {0, 0});
  map.add_observation(id, {2, 0});
  map.refresh_landmark(id);
  const Landmark& landmark = *map.find_landmark(id);
  EXPECT_NEAR(landmark.static_probability, 0.5, 1e-6);
  EXPECT_EQ(landmark.descriptor[0], 0x00);
  EXPECT_NEAR(landmark.max_distance_m, std::hypot(0.1, 2.0) * 1.44, 1e-9);
  EXPECT_NEAR(landmark.max_distance_m / landmark.min_distance_m, std::pow(1.2, 7), 1e-9);
}

TEST(Map, landmark_is_in_question_until_a_keyframe_sees_it_when_it_is_not) {
  Map map;
  for (std::uint32_t k = 0; k < 2; ++k) {
    msg::Feature feature{};
    feature.static_probability = k == 0 ? 0.5F : 0.9F;
    feature.flags = k == 0 ? msg::kFeatureInQuestion : 0;
    add_view(map, feature);
  }
  const msg::Feature& doubted = map.find_keyframe(0)->frame->features[0];
  const msg::Feature& known = map.find_keyframe(1)->frame->features[0];
  const LandmarkId id = map.add_landmark({0, 0, 2}, {0, 0});
  map.refresh_landmark(id);
  const Landmark& landmark = *map.find_landmark(id);
  EXPECT_TRUE(landmark.in_question);
  EXPECT_LT(static_weight(doubted, landmark.static_probability, landmark.in_question), 0.01);
  EXPECT_NEAR(static_weight(known, landmark.static_probability, landmark.in_question), 0.5, 1e-6);
  map.add_observation(id, {1, 0});
  map.refresh_landmark(id);
  EXPECT_FALSE(landmark.in_question);
  EXPECT_NEAR(landmark.static_probability, 0.9, 1e-6) << "of when it was known";
  EXPECT_NEAR(static_weight(doubted, landmark.static_probability, landmark.in_question), 0.9, 1e-6);
}

TEST(Map, keeps_its_invariants_under_random_edits) {
  std::mt19937_64 random(11);
  Map map;
  KeyframeId newest = map.add_keyframe(make_test_frame(0), moved_right(0), kNoKeyframe);
  const auto any_landmark = [&]() -> LandmarkId {
    const auto ids = map.landmark_ids();
    return ids.empty() ? kNoLandmark : ids[random() % ids.size()];
  };
  const auto any_keyframe = [&] {
    auto it = map.keyframes().begin();
    std::advance(it, static_cast<std::ptrdiff_t>(random() % map.keyframes().size()));
    return it->first;
  };
  for (int step = 0; step < 3000; ++step) {
    const auto feature = static_cast<std::uint32_t>(random() % 60);
    const LandmarkId landmark = any_landmark();
    const auto action = random() % 12;
    if (action == 0) newest = map.add_keyframe(make_test_frame(newest + 1), moved_right(0.01 * step), any_keyframe());
    if (action >= 1 && action < 4) {
      const KeyframeId keyframe = any_keyframe();
      if (map.find_keyframe(keyframe)->landmarks[feature] == kNoLandmark)
        map.add_landmark({1, 2, 3}, {keyframe, feature});
    }
    if (landmark == kNoLandmark) continue;
    if (action >= 4 && action < 8) map.add_observation(landmark, {any_keyframe(), feature});
    if (action == 8) map.remove_observation(landmark, any_keyframe());
    if (action == 9) map.replace_landmark(landmark, any_landmark());
    if (action == 10 && random() % 4 == 0) map.remove_landmark(landmark);
    if (const KeyframeId victim = any_keyframe(); action == 11 && victim != 0) map.remove_keyframe(victim);
    if (step % 50 == 0) {
      ASSERT_EQ(map.check_invariants(), "") << "step " << step;
    }
  }
  EXPECT_GT(map.keyframes().size(), 1U);
}

TEST(ForgetRemoved, keeps_what_is_recent_or_ends_a_loop_at_its_place) {
  Map map;
  for (KeyframeId id = 0; id < 8; ++id)
    map.add_keyframe(make_test_frame(id), moved_right(id), id == 0 ? kNoKeyframe : id - 1);
  for (const KeyframeId id : {1U, 2U, 3U, 4U, 5U}) map.remove_keyframe(id);
  map.add_loop({2, 7, moved_right(5)});
  map.forget_removed(1);
  EXPECT_EQ(map.removed_keyframes().size(), 2U);
  EXPECT_NEAR(map.T_world_keyframe(2).translation().x(), 2, 1e-12) << "a loop ends there";
  EXPECT_NEAR(map.T_world_keyframe(5).translation().x(), 5, 1e-12) << "the last to go";
  EXPECT_THROW(map.T_world_keyframe(3), std::out_of_range);
  map.find_keyframe(0)->T_world_camera = moved_right(10);
  EXPECT_NEAR(map.T_world_keyframe(2).translation().x(), 12, 1e-12) << "hangs on the first now";
  EXPECT_EQ(map.check_invariants(), "");
}

TEST(SpreadCertainty, makes_the_newest_keyframe_of_a_loop_as_certain_as_the_place) {
  Map map = make_map();
  for (const KeyframeId id : {0U, 1U, 2U}) {
    map.find_keyframe(id)->covariance = (1.0 + id) * geometry::Matrix6d::Identity();
  }
  const KeyframeId after = map.add_keyframe(make_test_frame(3), moved_right(0.3), 2);
  map.find_keyframe(after)->covariance = 5 * geometry::Matrix6d::Identity();
  spread_certainty(map, 0, 2);
  const auto variance = [&map](KeyframeId id) { return (*map.find_keyframe(id)->covariance)(0, 0); };
  EXPECT_EQ(variance(0), 1);
  EXPECT_EQ(variance(1), 1.5) << "half of the way";
  EXPECT_EQ(variance(2), 1);
  EXPECT_EQ(variance(after), 1) << "what came after hangs on it";
  spread_certainty(map, 7, 9);  // keyframes that have been removed since: nothing
}

constexpr double kDistance_m = 2, kFocal_px = 520;

/// One landmark straight ahead, seen by keyframes side by side, `step_m` apart.
Map map_of(int keyframes, double step_m, float depth_m = 0) {
  Map map;
  for (int k = 0; k < keyframes; ++k) {
    auto frame = std::make_shared<Frame>();
    frame->stamp_ns = 1'000'000'000LL * (k + 1);
    frame->camera = {kFocal_px, kFocal_px, 320, 240, 40};
    msg::Feature feature{};
    feature.depth_m = depth_m;
    frame->features.push_back(feature);
    map.add_keyframe(frame, Eigen::Isometry3d(Eigen::Translation3d(step_m * k, 0, 0)),
                     k == 0 ? kNoKeyframe : static_cast<KeyframeId>(k - 1));
    if (k == 0) map.add_landmark({0, 0, kDistance_m}, {0, 0});
    if (k > 0) map.add_observation(0, {static_cast<KeyframeId>(k), 0});
  }
  return map;
}

TEST(LandmarkFacts, name_the_landmark_and_when_it_was_seen) {
  const Map map = map_of(3, 0.1);
  const auto facts = facts_of_landmark(map, 0, {0.004, 0, kDistance_m});
  ASSERT_TRUE(facts.has_value());
  EXPECT_EQ(facts->id, 0U);
  EXPECT_EQ(facts->seen_ns, (std::vector<std::int64_t>{1'000'000'000, 2'000'000'000, 3'000'000'000}));
  EXPECT_EQ(facts->p_world.z(), kDistance_m);
  EXPECT_FALSE(facts_of_landmark(map, 0, {1, 0, kDistance_m})) << "nothing there";
  EXPECT_FALSE(facts_of_landmark(map, 1, {-0.1, 0, kDistance_m})) << "it belongs to another keyframe";
  EXPECT_FALSE(facts_of_landmark(map, 99, {0, 0, kDistance_m}));
}

TEST(LandmarkFacts, certainty_is_that_of_triangulation) {
  EXPECT_FALSE(facts_of_landmark(map_of(1, 0.1), 0, {0, 0, kDistance_m})->covariance) << "one ray has no depth";
  const auto two = facts_of_landmark(map_of(2, 0.2), 0, {0, 0, kDistance_m});
  const double sideways_m = kDistance_m / kFocal_px;  // of 1 px
  EXPECT_NEAR(std::sqrt((*two->covariance)(1, 1)), sideways_m / std::sqrt(2), 2e-4) << "two rays";
  const double along_m = std::sqrt(2) * sideways_m * kDistance_m / 0.2;  // of a stereo pair with that baseline
  EXPECT_NEAR(geometry::largest_sigma(*two->covariance), along_m, 0.05 * along_m);
  const auto measured = facts_of_landmark(map_of(1, 0, 2.0F), 0, {0, 0, kDistance_m});
  EXPECT_NEAR(std::sqrt((*measured->covariance)(2, 2)), kDistance_m * kDistance_m / 40, 1e-3) << "by its disparity";
}

}  // namespace
}  // namespace rtd::slam
