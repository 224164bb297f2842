// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Loops on rendered scenes. One seed of each here; RTD_LOOP_SEEDS=10 walks that many, with and without loop closing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "tests/support/offline_pipeline.hpp"

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

}  // namespace
}  // namespace rtd::test_support
