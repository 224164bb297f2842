// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/clip_uri.hpp"
#include "tests/support/filter_quality.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

/// What geometry alone must reach on a clip; a little below what it was measured to do (docs/theory/dynamic_points.md).
struct Demand {
  const char* clip;
  double precision, recall, pose_error_m;
};

class FilterClips : public ::testing::TestWithParam<Demand> {};

TEST_P(FilterClips, geometry_alone_finds_the_movers) {
  const auto clip = EvaluationClip::find(GetParam().clip);
  if (!clip) GTEST_SKIP() << "RTD_DATA_DIR has no " << GetParam().clip;
  filter::FilterConfig config;
  config.mode = filter::FilterMode::kGeometry;
  const FilterQuality quality = measure_filter(*clip, config);
  EXPECT_GE(quality.precision(), GetParam().precision);
  EXPECT_GE(quality.recall(), GetParam().recall);
  EXPECT_LE(quality.max_pose_error_m, GetParam().pose_error_m) << "m";
}

INSTANTIATE_TEST_SUITE_P(walks, FilterClips,
                         ::testing::Values(Demand{"walk_xyz", 0.95, 0.97, 0.06}, Demand{"walk_rpy", 0.93, 0.88, 0.06},
                                           Demand{"walk_box", 0.96, 0.95, 0.05}),
                         [](const auto& tested) { return std::string(tested.param.clip); });

TEST(FilterDesk, leaves_a_real_static_desk_alone) {
  const auto clip = EvaluationClip::find("fr1_xyz");
  if (!clip) GTEST_SKIP() << "RTD_DATA_DIR has no fr1_xyz";
  filter::FilterConfig config;
  config.mode = filter::FilterMode::kGeometry;
  EXPECT_LE(measure_filter(*clip, config).removed_wrongly_per_frame(), 25.0) << "of about 1200 features";
}

eval::RemovalQuality removal_with(const std::string& masks) {
  OfflineOptions options;
  options.source = clip_uri("kinect_half", "?masks=1");
  options.front_end.mode = "rtd";
  options.front_end.detector.masks = masks;
  return run_offline(options).removal;
}

/// Measured: 0.886 / 0.989 with boxes, 0.919 / 0.996 with the true pixels (docs/lab/accuracy.md).
TEST(PersonMasks, leave_more_of_the_surroundings_and_less_of_the_people) {
  if (clip_uri("kinect_half").empty()) GTEST_SKIP() << "RTD_DATA_DIR has no kinect_half";
  if (std::getenv("RTD_MODEL_DIR") == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
  const eval::RemovalQuality boxes = removal_with("off"), pixels = removal_with("truth");
  EXPECT_GE(pixels.precision(), 0.905);
  EXPECT_GE(pixels.precision(), boxes.precision() + 0.015);
  EXPECT_GE(pixels.recall(), 0.985);
}

}  // namespace
}  // namespace rtd::test_support
