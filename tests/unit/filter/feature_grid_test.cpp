// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/features.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace rtd::vision {
namespace {

msg::Feature feature_at(float u_px, float v_px, int octave = 0) {
  msg::Feature feature{};
  feature.u_px = u_px;
  feature.v_px = v_px;
  feature.octave = static_cast<std::uint8_t>(octave);
  return feature;
}

TEST(FeatureGrid, finds_what_a_search_through_all_features_finds) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> u(-20, 660), v(-20, 500);
  std::vector<msg::Feature> features;
  for (int i = 0; i < 1000; ++i) features.push_back(feature_at(u(random), v(random), i % 8));
  const FeatureGrid grid(features, 640, 480);
  for (int i = 0; i < 50; ++i) {
    const SearchWindow window{u(random), v(random), 35.0F, 2, 5};
    std::vector<std::uint32_t> expected;
    for (std::uint32_t k = 0; k < features.size(); ++k) {
      const msg::Feature& f = features[k];
      const bool near = std::abs(f.u_px - window.u_px) <= 35 && std::abs(f.v_px - window.v_px) <= 35;
      if (near && f.octave >= 2 && f.octave <= 5) expected.push_back(k);
    }
    EXPECT_THAT(grid.find(window), testing::UnorderedElementsAreArray(expected));
  }
}

TEST(FeatureGrid, keeps_features_that_undistortion_moved_out_of_the_image) {
  const std::vector<msg::Feature> features{feature_at(-7, 100), feature_at(646, 100)};
  const FeatureGrid grid(features, 640, 480);
  EXPECT_THAT(grid.find({-5, 100, 5}), testing::ElementsAre(0));
  EXPECT_THAT(grid.find({645, 100, 5}), testing::ElementsAre(1));
}

TEST(FeatureGrid, is_empty_without_features) {
  EXPECT_TRUE(FeatureGrid().find({10, 10, 100}).empty());
  EXPECT_TRUE(FeatureGrid({}, 640, 480).find({10, 10, 1000}).empty());
}

TEST(FeatureGrid, stays_small_and_finds_everything_whatever_the_size_of_the_image_says) {
  constexpr int kMax = std::numeric_limits<int>::max();
  const std::vector<msg::Feature> features{feature_at(10, 10), feature_at(2e9F, 10), feature_at(10, 2e9F)};
  for (const auto& [width_px, height_px] :
       {std::pair(kMax, kMax), {1'000'000'000, 1'000'000'000}, {kMax, 1}, {1, kMax}, {-5, 0}}) {
    const FeatureGrid grid(features, width_px, height_px);
    EXPECT_THAT(grid.find({10, 10, 5}), testing::ElementsAre(0)) << width_px << "x" << height_px;
    EXPECT_THAT(grid.find({2e9F, 10, 5}), testing::ElementsAre(1)) << width_px << "x" << height_px;
    EXPECT_THAT(grid.find({10, 2e9F, 5}), testing::ElementsAre(2)) << width_px << "x" << height_px;
  }
}

TEST(FeatureGrid, finds_nothing_around_a_position_that_is_no_number) {
  const std::vector<msg::Feature> features{feature_at(10, 10)};
  EXPECT_TRUE(FeatureGrid(features, 640, 480).find({std::nanf(""), 10, 5}).empty());
}

}  // namespace
}  // namespace rtd::vision
