// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/map_scale.hpp"

#include <gtest/gtest.h>

#include <ctime>

#include "services/slam/core/map/landmark.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::test_support {
namespace {

std::int64_t cpu_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

MapScaleOptions few_features(std::size_t keyframes) {
  MapScaleOptions options;
  options.keyframes = keyframes;
  options.full_mapping = 10;
  options.compared_frames = 60;
  options.world.points_per_m3 = 14;  // about 200 features
  options.now_ns = cpu_ns;
  return options;
}

/// The 10,000 keyframes are bench/rtd_map_scale's.
TEST(MapScale, frames_cost_the_same_in_a_larger_map) {
  const MapScaleReport report = run_map_scale(few_features(400));
  EXPECT_EQ(report.broken_invariant, "");
  EXPECT_EQ(report.lost_frames, 0U);
  EXPECT_GE(report.keyframes, 400U);
  EXPECT_LT(report.max_error_m, 0.05);
  if (checks_time()) {
    EXPECT_LT(median(report.large.tracking), 3 * median(report.small.tracking) / 2);
  }
}

TEST(MapScale, a_room_does_not_fill_up_with_keyframes) {
  MapScaleOptions options = few_features(300);
  options.path = WalkPath::kRoom;
  options.full_mapping = options.keyframes;  // only fused landmarks show that a keyframe is redundant
  const MapScaleReport report = run_map_scale(options);
  EXPECT_EQ(report.broken_invariant, "");
  EXPECT_EQ(report.lost_frames, 0U);
  EXPECT_LT(report.keyframes, 220U);
}

}  // namespace
}  // namespace rtd::test_support

namespace rtd::slam {
namespace {

TEST(LandmarkStore, finds_what_lives_and_uses_places_again) {
  LandmarkStore store;
  for (LandmarkId id = 0; id < 5000; ++id) store.emplace(id, {}).id = id;
  const Landmark* stays = store.find(4999);
  for (LandmarkId id = 0; id < 4999; ++id) store.erase(id);
  EXPECT_EQ(store.size(), 1U);
  EXPECT_EQ(store.find(17), nullptr);
  EXPECT_EQ(store.find(4'000'000'000U), nullptr);
  const Landmark* added = &store.emplace(4'000'000'000U, {});
  EXPECT_EQ(store.find(4'000'000'000U), added);
  EXPECT_EQ(store.find(4999), stays) << "a landmark stays where it is";
  EXPECT_EQ(store.ids(), (std::vector<LandmarkId>{4999, 4'000'000'000U}));
  EXPECT_THROW(store.at(17), std::out_of_range);
}

}  // namespace
}  // namespace rtd::slam
