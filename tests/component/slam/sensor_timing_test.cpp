// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

OfflineReport run_rolling_scene(const std::string& timing) {
  OfflineOptions options;
  options.source = "synthetic:static?frames=150&rolling_shutter_ms=30&timing=" + timing;
  options.front_end.mode = "off";
  return run_offline(options);
}

TEST(SensorTiming, a_source_that_knows_its_readout_time_improves_the_trajectory_from_the_first_frame) {
  const OfflineReport unknown = run_rolling_scene("unknown"), known = run_rolling_scene("known");
  EXPECT_EQ(known.readout_s, 0.03);
  EXPECT_NE(unknown.readout_s, 0.03) << "estimated";
  EXPECT_EQ(known.coverage, 1);
  EXPECT_LT(known.ate_rmse_m, 0.7 * unknown.ate_rmse_m);
  RecordProperty("ate_unknown_m", std::to_string(unknown.ate_rmse_m));
  RecordProperty("ate_known_m", std::to_string(known.ate_rmse_m));
}

}  // namespace
}  // namespace rtd::test_support
