// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/unit/filter/moving_scene.hpp"

namespace rtd::filter {
namespace {

using test::MovingScene;
using test::removed_share;

constexpr std::uint64_t kSits = 300, kWalks = 20, kStands = 90;  // frames at 30 Hz
constexpr double kStepM = 0.03;

/// A person sits for 10 s, walks off at 0.9 m/s and stops, before a camera that sways; a detector sees it in every
/// frame. Rendered and judged once for all tests.
class SittingPerson : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const MovingScene scene;
    FilterConfig config;
    DynamicFilter filter(config, [] { return std::int64_t{0}; });
    for (std::uint64_t i = 0; i < kSits + kWalks + kStands; ++i) {
      const double camera_x_m = 0.03 * std::sin(0.05 * static_cast<double>(i));
      const double steps = i < kSits ? 0.0 : static_cast<double>(std::min(i - kSits + 1, kWalks));
      const double person_x_m = -0.3 + kStepM * steps;
      const cv::Rect person = MovingScene::block(camera_x_m, person_x_m);
      const std::vector<vision::Detection> boxes{
          {"person", 0.9F, static_cast<float>(person.x - 10), static_cast<float>(person.y - 10),
           static_cast<float>(person.width + 20), static_cast<float>(person.height + 20)}};
      const FilterResult result = filter.apply(scene.render(i, camera_x_m, person_x_m), boxes);
      gone_[i] = removed_share(result, person, true);
      background_gone_[i] = removed_share(result, person, false);
    }
  }
  static inline std::map<std::uint64_t, double> gone_, background_gone_;  ///< share of the features, by frame
};

TEST_F(SittingPerson, is_not_used_when_first_seen) {
  EXPECT_GE(gone_.at(0), 0.95);
  EXPECT_GE(gone_.at(5), 0.95);
}

TEST_F(SittingPerson, is_used_again_within_two_seconds) {
  for (std::uint64_t i = 60; i < kSits; i += 10) EXPECT_LE(gone_.at(i), 0.1) << "frame " << i;
}

TEST_F(SittingPerson, is_dropped_within_three_frames_of_rising) {
  for (std::uint64_t i = kSits + 2; i < kSits + kWalks; ++i) EXPECT_GE(gone_.at(i), 0.95) << "frame " << i;
}

TEST_F(SittingPerson, is_used_again_within_two_seconds_of_stopping) {
  EXPECT_GE(gone_.at(kSits + kWalks + 10), 0.9) << "a third of a second is too early";
  for (std::uint64_t i = kSits + kWalks + 60; i < kSits + kWalks + kStands; i += 5)
    EXPECT_LE(gone_.at(i), 0.1) << "frame " << i;
}

TEST_F(SittingPerson, removes_nothing_of_the_room) {
  for (const auto& [frame, share] : background_gone_) EXPECT_LE(share, 0.08) << "frame " << frame;
}

}  // namespace
}  // namespace rtd::filter
