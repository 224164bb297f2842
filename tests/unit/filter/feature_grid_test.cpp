// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/features.hpp"

#include <gmock/gmock.h>

#include <random>

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

}  // namespace
}  // namespace rtd::vision
