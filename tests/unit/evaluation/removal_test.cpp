// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "services/evaluation/core/removal/removal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;

/// Moving: the square 100..199.
cv::Mat square() {
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(100, 100, 100, 100)).setTo(255);
  return mask;
}

TEST(RemovalQuality, counts_removed_points_on_the_grown_mask_and_kept_ones_on_the_mask) {
  RemovalQuality quality;
  const std::vector<run_record::JudgedFeature> features{
      {150, 150, true}, {202, 150, true}, {204, 150, true}, {150, 150, false}, {202, 150, false}};
  quality.count(features, square());
  EXPECT_EQ(quality.removed_rightly, 2U) << "3 px beside the mask still counts";
  EXPECT_EQ(quality.removed_wrongly, 1U);
  EXPECT_EQ(quality.kept_wrongly, 1U);
  EXPECT_EQ(quality.kept_rightly, 1U);
  EXPECT_NEAR(quality.precision(), 2.0 / 3, 1e-12);
  EXPECT_NEAR(quality.recall(), 2.0 / 3, 1e-12);
}

TEST(RemovalQuality, knows_what_it_does_not_know) {
  RemovalQuality quality;
  quality.count(std::vector<run_record::JudgedFeature>{{10, 10, false}}, cv::Mat());
  EXPECT_TRUE(std::isnan(quality.precision())) << "nothing was removed";
  EXPECT_TRUE(std::isnan(quality.recall())) << "nothing had to be";
  quality.count(std::vector<run_record::JudgedFeature>{{-50, 1e6F, true}}, square());
  EXPECT_EQ(quality.removed_wrongly, 1U) << "outside the image: the nearest pixel";
}

TEST(TrueMasks, are_read_by_stamp_from_a_folder) {
  const rtd::test::TemporaryFolder folder;
  fs::create_directory(folder / "mask");
  cv::imwrite((folder / "mask" / "10.500000.png").string(), square());
  cv::imwrite((folder / "mask" / "12.000000.png").string(), square());
  cv::imwrite((folder / "mask" / "cover.png").string(), square());
  const std::string uri = "tum:" + folder.path().string();
  EXPECT_TRUE(run_record::has_true_masks(uri + "?masks=1"));
  const std::vector<run_record::JudgedFeature> moving{{150, 150, true}};
  const auto removal =
      judge_removal(uri, {{10'500'000'000, moving}, {11'000'000'000, moving}, {12'000'000'000, moving}});
  ASSERT_TRUE(removal);
  EXPECT_EQ(removal->frames, 2U) << "one has no mask";
  EXPECT_EQ(removal->all.removed_rightly, 2U);
  EXPECT_EQ(removal->settled.removed_rightly, 1U) << "after the first second";
  EXPECT_FALSE(judge_removal(uri, {{99, moving}})) << "none fits";
  fs::remove_all(folder.path());
  EXPECT_FALSE(run_record::has_true_masks(uri));
  EXPECT_FALSE(judge_removal(uri, {{10'500'000'000, moving}}));
}

TEST(TrueMasks, of_a_synthetic_scene_are_rendered_again) {
  constexpr std::int64_t kFirstNs = 1'000'000'000'000;
  std::vector<run_record::JudgedFeature> everywhere;
  for (int v = 2; v < 480; v += 8) {
    for (int u = 2; u < 640; u += 8) everywhere.push_back({static_cast<float>(u), static_cast<float>(v), true});
  }
  const auto removal = judge_removal("synthetic:office?frames=2", {{kFirstNs, everywhere}});
  ASSERT_TRUE(removal);
  EXPECT_GT(removal->all.removed_rightly, 100U);
  EXPECT_GT(removal->all.removed_wrongly, removal->all.removed_rightly) << "most of the room rests";
  EXPECT_FALSE(run_record::has_true_masks("openni:0"));
}

/// Stamps come from other processes.
TEST(TrueMasks, of_an_endless_scene_are_not_looked_for_at_the_end_of_time) {
  constexpr std::int64_t kEnd = std::numeric_limits<std::int64_t>::max();
  const std::vector<run_record::JudgedFeature> moving{{150, 150, true}};
  const auto removal =
      judge_removal("synthetic:office?frames=0", {{-kEnd, moving}, {1'000'000'000'000, moving}, {kEnd - 7, moving}});
  ASSERT_TRUE(removal);
  EXPECT_EQ(removal->frames, 1U);
}

TEST(TrueMasks, are_looked_at_evenly_spread_or_until_the_user_interrupts) {
  const rtd::test::TemporaryFolder folder;
  fs::create_directory(folder / "mask");
  std::vector<run_record::JudgedFrame> frames;
  for (int second = 10; second < 17; ++second) {
    cv::imwrite((folder / "mask" / (std::to_string(second) + ".000000.png")).string(), square());
    frames.push_back({second * 1'000'000'000LL, {{150, 150, second % 3 == 1}}});  // removed in 10, 13 and 16
  }
  const std::string uri = "tum:" + folder.path().string();
  JudgeLimits limits;
  limits.most_frames = 3;
  const auto spread = judge_removal(uri, frames, limits);
  ASSERT_TRUE(spread);
  EXPECT_EQ(spread->frames, 3U);
  EXPECT_EQ(spread->all.removed_rightly, 3U) << "every third";
  int asked = 0;
  limits = {.go_on = [&asked] { return ++asked < 3; }};
  EXPECT_EQ(judge_removal(uri, frames, limits)->frames, 2U);
}

}  // namespace
}  // namespace rtd::eval
