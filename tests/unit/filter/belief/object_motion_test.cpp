// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/belief/static_probability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rtd::filter {
namespace {

constexpr std::size_t kGridCells = 1200;
const std::vector<int> kObject{10, 11, 12, 13};

/// Features on an object that has shifted, with 1 px of noise each, and as many beside it that rest.
FeatureVotes shifted_by(float x_px, int features) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise_px(0, 1);
  FeatureVotes votes;
  for (int i = 0; i < features; ++i) {
    votes.shifts.push_back(
        {kObject[static_cast<std::size_t>(i) % kObject.size()], x_px + noise_px(random), noise_px(random)});
    votes.shifts.push_back({500, noise_px(random), noise_px(random)});
  }
  return votes;
}
bool moves(const FeatureVotes& votes) {
  return drifts(drift_of(kObject, votes, kGridCells), BeliefConfig{});
}

TEST(ObjectDrift, is_more_precise_than_the_shift_of_one_feature) {
  const ObjectDrift drift = drift_of(kObject, shifted_by(3, 100), kGridCells);
  EXPECT_EQ(drift.features, 100);
  EXPECT_NEAR(drift.shift_px, 3, 0.4);
  EXPECT_NEAR(drift.sigma_px, std::sqrt(2 * 1.57 / 100), 0.05) << "two axes";
}

TEST(ObjectDrift, distinguishes_a_shift_of_three_pixels_from_rest) {
  EXPECT_TRUE(moves(shifted_by(3, 100)));
  EXPECT_FALSE(moves(shifted_by(0, 100)));
  EXPECT_FALSE(moves(shifted_by(1.4F, 100))) << "the pose may be off so far";
}

TEST(ObjectDrift, makes_no_statement_about_few_features_or_none) {
  EXPECT_FALSE(moves(shifted_by(5, 8)));
  EXPECT_FALSE(moves({}));
}

TEST(ObjectDrift, does_not_take_waving_arms_for_the_person) {
  FeatureVotes votes = shifted_by(0, 100);
  for (std::size_t i = 0; i < 60; i += 2) votes.shifts[i].x_px += 10;
  EXPECT_FALSE(moves(votes));
}

}  // namespace
}  // namespace rtd::filter
