// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/clip_uri.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {
namespace {

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
