// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/mover_trails.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <utility>

namespace rtd::geometry {
namespace {

using ::testing::Each;

/// From `low` to `high` along x.
msg::Movers one(double stamp_s, double low, double high, double velocity_m_s, double sigma_m_s = 0.01) {
  msg::Movers frame;
  frame.stamp_ns = static_cast<std::int64_t>(stamp_s * 1e9);
  msg::Mover& mover = frame.movers.emplace_back();
  mover.id = 1;
  mover.center_m = {(low + high) / 2, 0, 2};
  mover.size_m = {high - low, 1, 1};
  mover.velocity_mps = {velocity_m_s, 0, 0};
  for (std::size_t place = 0; place < 36; place += 7) mover.covariance[place] = sigma_m_s * sigma_m_s;
  return frame;
}

/// What is said of an object at 10 Hz for two seconds; sides(time_s): where it begins and ends along x.
std::vector<bool> said(const std::function<std::pair<double, double>(double)>& sides, double velocity_m_s) {
  MoverTrails trails;
  std::vector<bool> rest;
  for (int i = 0; i <= 20; ++i) {
    const auto [low, high] = sides(i / 10.0);
    rest.push_back(trails.rest(one(i / 10.0, low, high, velocity_m_s))[0]);
  }
  return rest;
}

TEST(MoverTrails, an_object_that_goes_as_fast_as_it_is_said_to_moves_once_its_trail_is_long_enough) {
  const std::vector<bool> rest = said([](double t_s) { return std::pair(0.8 * t_s, 0.8 * t_s + 0.5); }, 0.8);
  EXPECT_TRUE(rest[7]);
  EXPECT_FALSE(rest[8]);
  EXPECT_FALSE(rest[20]);
}

TEST(MoverTrails, one_that_comes_into_view_grows_on_one_side_and_rests) {
  EXPECT_THAT(said([](double t_s) { return std::pair(0.0, 0.3 + t_s); }, 0.5), Each(true));
  EXPECT_THAT(said([](double) { return std::pair(0.0, 1.0); }, 1), Each(true)) << "with a velocity it does not follow";
}

TEST(MoverTrails, a_trail_with_a_gap_or_with_time_that_went_back_begins_again) {
  MoverTrails trails;
  const auto at = [&trails](double stamp_s) -> bool { return trails.rest(one(stamp_s, stamp_s, stamp_s + 1, 1))[0]; };
  EXPECT_EQ((std::array{at(0), at(1), at(1.2), at(9), at(0)}), (std::array{true, false, false, true, true}));
}

TEST(MoverTrails, a_velocity_that_may_be_noise_says_that_it_rests) {
  MoverTrails trails;
  const auto last = [&trails](double sigma_m_s) -> bool {
    trails = {};
    trails.rest(one(0, 0, 1, 0.5, sigma_m_s));
    return trails.rest(one(1, 0.5, 1.5, 0.5, sigma_m_s))[0];
  };
  EXPECT_FALSE(last(0.1));
  EXPECT_TRUE(last(0.25));
  EXPECT_TRUE(last(0)) << "without a covariance";
}

}  // namespace
}  // namespace rtd::geometry
