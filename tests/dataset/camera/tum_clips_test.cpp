// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "common/camera/open/source_factory.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;

/// Real TUM sequences; skipped without RTD_DATA_DIR.
class TumClips : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RTD_DATA_DIR");
    if (folder == nullptr || !fs::exists(fs::path(folder) / "fr1_xyz")) {
      GTEST_SKIP() << "set RTD_DATA_DIR to the folder that holds fr1_xyz";
    }
    data_ = folder;
  }
  fs::path data_;
};

TEST_F(TumClips, plays_all_pairs_of_fr1_xyz_as_associated) {
  const auto source = make_source("tum:" + (data_ / "fr1_xyz").string());
  EXPECT_EQ(source->info().frames, 200U);
  std::vector<std::int64_t> stamps;
  cv::Mat second_depth, third_depth;
  while (const auto frame = source->next()) {
    stamps.push_back(frame->image.stamp_ns);
    if (stamps.size() == 2) second_depth = frame->image.depth;
    if (stamps.size() == 3) third_depth = frame->image.depth;
    ASSERT_TRUE(frame->has_depth);
  }
  ASSERT_EQ(stamps.size(), 200U);
  EXPECT_EQ(stamps.front(), 1305031102175304000);
  EXPECT_TRUE(std::is_sorted(stamps.begin(), stamps.end()));
  EXPECT_EQ(cv::norm(second_depth, third_depth, cv::NORM_L1), 0) << "associations.txt names one depth image twice";
  EXPECT_EQ(source->counters().skipped_total(), 0U);
  EXPECT_TRUE(source->info().camera.distorted());
}

TEST_F(TumClips, groundtruth_covers_the_clip_and_half_a_second_around_it) {
  const auto source = make_source("tum:" + (data_ / "fr1_xyz").string());
  const auto poses = source->groundtruth();
  ASSERT_GT(poses.size(), 600U);
  EXPECT_LT(poses.front().stamp_ns, 1305031102175304000);
  EXPECT_GT(poses.back().stamp_ns, 1305031108811244000);
}

TEST_F(TumClips, plays_original_pngs_of_a_family_without_calibration_file) {
  const auto source = make_source("tum:" + (data_ / "fr1_desk_9").string());
  EXPECT_DOUBLE_EQ(source->info().camera.parameters().fx, 517.306408);
  ASSERT_TRUE(source->next());
}

TEST_F(TumClips, associates_the_lists_and_skips_images_that_are_not_there) {
  const rtd::test::TemporaryFolder scratch;
  const fs::path folder = scratch / "fr1_desk_lists";
  fs::create_directory(folder);
  for (const char* name : {"rgb", "depth", "rgb.txt", "depth.txt"}) {
    fs::create_symlink(fs::absolute(data_ / "fr1_desk_9" / name), folder / name);
  }
  const auto source = make_source("tum:" + folder.string() + "?outside=1");
  int frames = 0;
  while (source->next()) ++frames;
  EXPECT_EQ(frames, 9) << "the lists name the whole sequence, nine pairs are there";
  EXPECT_GT(source->counters().of(SkipReason::kColorUnreadable), 500U);
}

TEST_F(TumClips, reads_the_masks_of_rendered_clips) {
  const auto source = make_source("tum:" + (data_ / "walk_xyz").string() + "?masks=1");
  double masked = 0;
  for (int i = 0; i < 20; ++i) masked += cv::countNonZero(source->next()->dynamic_mask) / 307200.0;
  EXPECT_GT(masked / 20, 0.05);
  EXPECT_LT(masked / 20, 0.6);
}

}  // namespace
}  // namespace rtd::camera
