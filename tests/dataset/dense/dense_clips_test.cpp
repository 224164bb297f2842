// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/dense/dense_run.hpp"
#include "tests/support/dense/grid_truth.hpp"

namespace rtd::test_support {
namespace {

/// The URI of a clip with its masks; the test is skipped without data.
std::string clip(const char* name) {
  const char* folder = std::getenv("RTD_DATA_DIR");
  const std::string path = std::string(folder == nullptr ? "" : folder) + "/" + name;
  return folder != nullptr && std::filesystem::is_directory(path) ? "tum:" + path + "?masks=1" : "";
}

DenseOptions options(const std::string& source, const std::string& mode) {
  DenseOptions options;
  options.source = source;
  options.front_end.mode = mode;
  return options;
}

TEST(DenseClips, people_who_walk_leave_no_ghosts) {
  const std::string source = clip("walk_xyz");
  if (source.empty() || std::getenv("RTD_MODEL_DIR") == nullptr) GTEST_SKIP() << "RTD_DATA_DIR and RTD_MODEL_DIR";
  const DenseReport report = run_dense(options(source, "rtd"));
  EXPECT_LT(report.ghosts.ghost_share(), 0.005);
  EXPECT_GT(report.ghosts.completeness, 0.95);
  EXPECT_LT(report.ghosts.error_median_m, 0.015) << "m";
}

TEST(DenseClips, boxes_that_are_carried_about_leave_few_ghosts) {
  const std::string source = clip("walk_box");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR";
  const DenseReport report = run_dense(options(source, "geometry"));
  EXPECT_LT(report.ghosts.ghost_share(), 0.02);
  EXPECT_GT(report.ghosts.completeness, 0.9);
}

TEST(DenseClips, a_synthetic_room_is_mapped_without_moving_objects) {
  DenseOptions synthetic = options("synthetic:office?frames=120", "rtd");
  synthetic.front_end.detector.kind = "truth";
  synthetic.grid = true;
  const DenseReport with_masks = run_dense(synthetic);
  EXPECT_LT(with_masks.ghosts.ghost_share(), 0.01);
  EXPECT_GT(with_masks.ghosts.completeness, 0.8);

  ASSERT_TRUE(with_masks.grid.has_value());
  EXPECT_NEAR(with_masks.grid->floor_m, 0, 0.03) << "m";
  const GridTruth truth(synthetic.source, with_masks.grid->cell_m, synthetic.navigation.heights);
  const GridReport plan = truth.judge(*with_masks.grid);
  EXPECT_GE(plan.share_right(), 0.99);
  EXPECT_EQ(plan.ghosts, 0U) << "people were everywhere in the middle of the room";
  EXPECT_GT(plan.free, 2000U);
  EXPECT_GT(plan.occupied, 300U);
}

}  // namespace
}  // namespace rtd::test_support
