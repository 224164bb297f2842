// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
/// Loops on rendered scenes. One seed of each here; RTD_LOOP_SEEDS=10 walks that many, with and without loop closing.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/support/clip_uri.hpp"
#include "tests/support/offline_pipeline.hpp"
#include "tests/support/relocalization_trial.hpp"

namespace rtd::test_support {
namespace {

OfflineReport run(const std::string& scene, int seed, bool loop_closing) {
  OfflineOptions options;
  options.source = "synthetic:" + scene + "?seed=" + std::to_string(seed);
  options.slam.techniques.loop_closing = loop_closing;
  return run_offline(options);
}

int seeds_asked_for() {
  const char* text = std::getenv("RTD_LOOP_SEEDS");
  return text == nullptr ? 0 : std::atoi(text);
}

void expect_true_loop(const OfflineReport& report) {
  EXPECT_EQ(report.coverage, 1.0);
  ASSERT_FALSE(report.loops.empty()) << "the corridor ends where it began";
  for (const ClosedLoop& loop : report.loops) {
    EXPECT_LT(loop.error_m, 0.1) << "false loop " << loop.closure.edge.older << " - " << loop.closure.edge.newer;
    EXPECT_LT(loop.error_rad, 0.02);
  }
}

TEST(CorridorLoop, is_found_and_takes_the_drift_out) {
  constexpr double kAteWithoutM = 0.2755;  // seed 1 with slam.techniques.loop_closing=false
  const OfflineReport report = run("corridor", 1, true);
  expect_true_loop(report);
  EXPECT_LE(report.ate_rmse_m, 0.2 * kAteWithoutM);
}

TEST(LookAlikePlaces, are_no_loop) {
  const OfflineReport report = run("lookalike", 1, true);
  EXPECT_TRUE(report.loops.empty());
  EXPECT_EQ(report.coverage, 1.0);
}

TEST(CorridorLoop, is_found_on_many_seeds) {
  if (seeds_asked_for() == 0) GTEST_SKIP() << "RTD_LOOP_SEEDS is not set";
  for (int seed = 1; seed <= seeds_asked_for(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const OfflineReport before = run("corridor", seed, false), after = run("corridor", seed, true);
    std::printf("corridor seed %2d: ATE %.4f -> %.4f m (%.0f %%), %zu loops\n", seed, before.ate_rmse_m,
                after.ate_rmse_m, 100 * after.ate_rmse_m / before.ate_rmse_m, after.loops.size());
    expect_true_loop(after);
    EXPECT_LE(after.ate_rmse_m, 0.2 * before.ate_rmse_m);
  }
}

TEST(LookAlikePlaces, are_no_loop_on_many_seeds) {
  if (seeds_asked_for() == 0) GTEST_SKIP() << "RTD_LOOP_SEEDS is not set";
  for (int seed = 1; seed <= seeds_asked_for(); ++seed) {
    EXPECT_TRUE(run("lookalike", seed, true).loops.empty()) << "seed " << seed;
  }
}

// A few of the cuts that rtd_relocalization makes by the dozen.

/// The motion capture of fr1 turns that much before its images.
constexpr double kFr1TruthOffset_s = -0.015;

void expect_found(const FeatureClip& features, const WorldAlignment& alignment, const RelocalizationTrial& trial) {
  const auto outcome = run_relocalization(features, features, alignment, trial, {}, slam::MappingMode::kSynchronous);
  EXPECT_TRUE(outcome.found);
  EXPECT_LE(outcome.after_s, 1.0);
  EXPECT_LE(outcome.error_m, 0.02);
  EXPECT_LE(outcome.error_deg, 1.0);
  EXPECT_EQ(outcome.wrong, 0U) << "poses";
  EXPECT_EQ(outcome.maps, 1U);
}

TEST(Relocalization, finds_the_camera_in_the_room_of_walk_xyz) {
  const std::string source = clip_uri("walk_xyz", "?masks=1");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no walk_xyz";
  const FeatureClip features = record_features(source, 0, 200, true);
  const WorldAlignment alignment = align_worlds(features, {});
  expect_found(features, alignment, {.mapped = 126, .covered = 90, .resume = 164, .length = 15});
  // Carried on: things that look alike made 84 landmarks agree with a pose 43 cm off.
  expect_found(features, alignment, {.mapped = 105, .covered = 0, .resume = 129, .length = 15});
}

TEST(Relocalization, finds_the_camera_at_the_desk_of_fr1_xyz) {
  const std::string source = clip_uri("fr1_xyz");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  const FeatureClip features = record_features(source, 0, 200, false, kFr1TruthOffset_s);
  const WorldAlignment alignment = align_worlds(features, {});
  expect_found(features, alignment, {.mapped = 100, .covered = 90, .resume = 108, .length = 15});
  // Carried on without a break: the jump, taken for a velocity, bent the next frame by 12 cm.
  expect_found(features, alignment, {.mapped = 140, .covered = 0, .resume = 160, .length = 15});
}

TEST(Relocalization, recognises_no_room_that_it_has_not_seen) {
  const FeatureClip known = record_features("synthetic:static?seed=21", 0, 40, false);
  const FeatureClip strange = record_features("synthetic:static?seed=22", 0, 40, false);
  const auto outcome =
      run_relocalization(known, strange, WorldAlignment({}), {.mapped = 40, .covered = 50, .resume = 0, .length = 40},
                         {}, slam::MappingMode::kSynchronous);
  EXPECT_FALSE(outcome.found);
  EXPECT_EQ(outcome.wrong, 0U);
}

}  // namespace
}  // namespace rtd::test_support
