// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Rendered scenes with an IMU or wheels, in which a person fills the view or the light goes out. docs/results.md has
// all seeds: tests/campaigns/stress.py --sensors imu.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

OfflineReport run(const std::string& source, const std::string& mode, const OfflineOptions& base = {}) {
  OfflineOptions options = base;
  options.source = "synthetic:" + source;
  options.front_end.mode = mode;
  options.front_end.detector.kind = "truth";
  const OfflineReport report = run_offline(options);
  std::printf("%s: coverage %.3f, ATE %.4f m, as published %.4f m, predicted %zu\n", source.c_str(), report.coverage,
              report.ate_rmse_m, report.online_ate_rmse_m, report.predicted_frames);
  return report;
}

/// To where the person has been in front of the camera for a second.
TEST(InertialScenes, a_person_fills_the_view) {
  const OfflineReport report = run("fill?frames=200&seed=2&imu=1", "rtd");
  EXPECT_GE(report.coverage, 0.98);
  EXPECT_LT(report.ate_rmse_m, 0.03);
}

TEST(InertialScenes, the_light_is_off_for_two_seconds) {
  const OfflineReport imu = run("static?frames=150&seed=1&dark_from=2&dark=2&imu=1", "off");
  EXPECT_GE(imu.coverage, 0.98);
  EXPECT_GE(imu.predicted_frames, 55U);
  EXPECT_LT(imu.ate_rmse_m, 0.03);
  const OfflineReport wheels = run("static?frames=150&seed=1&dark_from=2&dark=2&motion=driving&wheel=1", "off");
  EXPECT_GE(wheels.coverage, 0.98);
  EXPECT_LT(wheels.ate_rmse_m, 0.03);
}

}  // namespace
}  // namespace rtd::test_support
