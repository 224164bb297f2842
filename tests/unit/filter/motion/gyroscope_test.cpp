// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/ego_motion.hpp"

#include <gtest/gtest.h>

#include "common/geometry/se3.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kMs = 1'000'000;
const Eigen::Vector3d kTurning_rad_s(0.3, -0.5, 0.2);

/// Half a second of samples at 200 Hz.
Gyroscope turning(const GyroscopeConfig& config, const Eigen::Vector3d& rate_rad_s) {
  Gyroscope gyroscope(config);
  for (std::int64_t i = 0; i <= 100; ++i) gyroscope.add({i * 5 * kMs, rate_rad_s, Eigen::Vector3d::Zero()});
  return gyroscope;
}

TEST(Gyroscope, turns_as_the_camera_does_whatever_way_it_is_mounted) {
  GyroscopeConfig config;
  config.R_camera_imu = geometry::so3_exp({0.5, 1.2, -0.7});
  const auto turn = turning(config, config.R_camera_imu.transpose() * kTurning_rad_s).turn(103 * kMs, 400 * kMs);
  ASSERT_TRUE(turn);
  EXPECT_TRUE(turn->R_earlier_later.isApprox(geometry::so3_exp(0.297 * kTurning_rad_s), 1e-9));
}

TEST(Gyroscope, is_as_uncertain_as_its_bias_scale_and_noise) {
  GyroscopeConfig config;
  config.scale_error = 0;
  const auto at_rest = turning(config, Eigen::Vector3d::Zero()).turn(100 * kMs, 200 * kMs);
  ASSERT_TRUE(at_rest);
  const double variance = std::pow(config.bias_rad_s * 0.1, 2) + std::pow(config.noise_rad_s_rthz, 2) * 0.1;
  EXPECT_TRUE(at_rest->covariance.isApprox(variance * Eigen::Matrix3d::Identity(), 1e-6));
  config.scale_error = 0.01;
  const auto turned = turning(config, kTurning_rad_s).turn(100 * kMs, 200 * kMs);
  ASSERT_TRUE(turned);
  EXPECT_NEAR(turned->covariance.trace() / 3, variance + std::pow(0.01 * 0.1 * kTurning_rad_s.norm(), 2), 1e-9);
}

TEST(Gyroscope, says_nothing_without_samples) {
  EXPECT_FALSE(Gyroscope({}).turn(0, 100 * kMs));
  Gyroscope gyroscope = turning({}, kTurning_rad_s);
  EXPECT_FALSE(gyroscope.turn(300 * kMs, 900 * kMs)) << "they end before";
  gyroscope.forget_before(400 * kMs);
  EXPECT_FALSE(gyroscope.turn(100 * kMs, 450 * kMs)) << "they begin later";
  EXPECT_TRUE(gyroscope.turn(400 * kMs, 450 * kMs));
  gyroscope.clear();
  EXPECT_FALSE(gyroscope.turn(400 * kMs, 450 * kMs));
}

TEST(Gyroscope, goes_by_the_clock_of_the_camera) {
  GyroscopeConfig config;
  config.time_offset_s = 10;
  EXPECT_FALSE(turning(config, kTurning_rad_s).turn(100 * kMs, 200 * kMs));
  EXPECT_TRUE(turning(config, kTurning_rad_s).turn(10'100 * kMs, 10'200 * kMs));
}

}  // namespace
}  // namespace rtd::filter
