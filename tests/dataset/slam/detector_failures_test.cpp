// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// The clips with a detector that is slow, late, gone or lying; emulated by the stamps, so that runs repeat.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/clip_uri.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

/// Options for a clip below RTD_DATA_DIR; no source when it is not there.
OfflineOptions clip(const std::string& name, const std::string& mode) {
  OfflineOptions options;
  options.front_end.mode = mode;
  options.source = clip_uri(name);
  return options;
}

struct SlowClip {
  const char* name;
  double ate_m;  ///< the worse of the two tests, docs/results.md "Accuracy"
};
void PrintTo(const SlowClip& slow, std::ostream* out) {
  *out << slow.name;
}

class SlowDetector : public ::testing::TestWithParam<SlowClip> {
 protected:
  static void expect_poses_hardly_change(OfflineOptions options) {
    if (options.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().name;
    if (std::getenv("RTD_MODEL_DIR") == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
    const OfflineReport report = run_offline(options);
    EXPECT_LE(report.ate_rmse_m, 1.3 * GetParam().ate_m);
    EXPECT_GE(report.coverage, 1.0);
  }
};
INSTANTIATE_TEST_SUITE_P(Clips, SlowDetector,
                         ::testing::Values(SlowClip{"walk_xyz", 0.0024}, SlowClip{"walk_rpy", 0.0072},
                                           SlowClip{"walk_box", 0.0015}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_P(SlowDetector, at_5_hz_and_80_ms_late_hardly_changes_the_poses) {
  OfflineOptions options = clip(GetParam().name, "rtd");
  options.front_end.detector.rate_hz = 5;
  options.front_end.detector.delay_ms = 80;
  expect_poses_hardly_change(options);
}

TEST_P(SlowDetector, gone_for_a_second_hardly_changes_the_poses) {
  OfflineOptions options = clip(GetParam().name, "rtd");
  options.front_end.detector.outages = {{1.5, 2.5}};
  expect_poses_hardly_change(options);
}

class LyingDetector : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  static void SetUpTestSuite() {
    if (!clip("fr1_xyz", "off").source.empty()) off_ate_m_ = run_offline(clip("fr1_xyz", "off")).ate_rmse_m;
  }
  static inline double off_ate_m_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Seeds, LyingDetector, ::testing::Range<std::uint64_t>(1, 6));

TEST_P(LyingDetector, does_not_lead_the_camera_astray) {
  OfflineOptions lying = clip("fr1_xyz", "rtd");
  if (lying.source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  lying.front_end.detector.kind = "lying";
  lying.front_end.detector.seed = GetParam();
  const OfflineReport report = run_offline(lying);
  EXPECT_LE(report.ate_rmse_m, 1.6 * off_ate_m_);
  EXPECT_EQ(report.coverage, 1.0);
}

}  // namespace
}  // namespace rtd::test_support
