// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A few of the cuts that rtd_relocalization makes by the dozen.
#include <gtest/gtest.h>

#include "tests/support/clip_uri.hpp"
#include "tests/support/relocalization_trial.hpp"

namespace rtd::test_support {
namespace {

/// `max_deg`: fr1's truth is noisier than what is asked.
void expect_found(const FeatureClip& features, const RelocalizationTrial& trial, double max_deg) {
  const auto outcome = run_relocalization(features, features, trial, {}, slam::MappingMode::kSynchronous);
  EXPECT_TRUE(outcome.found);
  EXPECT_LE(outcome.after_s, 1.0);
  EXPECT_LE(outcome.error_m, 0.02);
  EXPECT_LE(outcome.error_deg, max_deg);
  EXPECT_EQ(outcome.wrong, 0U) << "poses";
  EXPECT_EQ(outcome.maps, 1U);
}

TEST(Relocalization, finds_the_camera_in_the_room_of_walk_xyz) {
  const std::string source = clip_uri("walk_xyz", "?masks=1");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no walk_xyz";
  const FeatureClip features = record_features(source, 0, 200, true);
  expect_found(features, {.mapped = 126, .covered = 90, .resume = 164, .length = 15}, 1.0);
  // Carried on: things that look alike made 84 landmarks agree with a pose 43 cm off.
  expect_found(features, {.mapped = 105, .covered = 0, .resume = 129, .length = 15}, 1.0);
}

TEST(Relocalization, finds_the_camera_at_the_desk_of_fr1_xyz) {
  const std::string source = clip_uri("fr1_xyz");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  const FeatureClip features = record_features(source, 0, 130, false);
  expect_found(features, {.mapped = 100, .covered = 90, .resume = 108, .length = 15}, 2.0);
}

TEST(Relocalization, knows_no_room_that_it_has_not_seen) {
  const FeatureClip known = record_features("synthetic:static?seed=21", 0, 40, false);
  const FeatureClip strange = record_features("synthetic:static?seed=22", 0, 40, false);
  const auto outcome = run_relocalization(known, strange, {.mapped = 40, .covered = 50, .resume = 0, .length = 40}, {},
                                          slam::MappingMode::kSynchronous);
  EXPECT_FALSE(outcome.found);
  EXPECT_EQ(outcome.wrong, 0U);
}

}  // namespace
}  // namespace rtd::test_support
