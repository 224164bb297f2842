// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/facts.hpp"

#include <gtest/gtest.h>

#include "common/geometry/se3.hpp"

namespace rtd::slam {
namespace {

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
