// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/inertial/preintegration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/camera/synthetic/camera_path.hpp"
#include "common/camera/synthetic/motion_sensors.hpp"
#include "common/geometry/se3.hpp"

namespace rtd::inertial {
namespace {

using camera::synthetic::CameraMotion;
using camera::synthetic::CameraPath;
using camera::synthetic::SyntheticImu;

constexpr std::int64_t kMs = 1'000'000;
const Eigen::Vector3d kGravity(0, 0, -9.80665);
constexpr ImuNoise kNoise{2e-4, 2e-3};

SyntheticImu::Options perfect() {
  SyntheticImu::Options options;
  options.gyro_noise_rad_s_rthz = options.accel_noise_m_s2_rthz = 0;
  options.gyro_bias_rad_s = options.accel_bias_m_s2 = 0;
  options.gyro_wander_rad_s = options.accel_wander_m_s2 = 0;
  return options;
}

ImuStream readings(const SyntheticImu& imu, int count) {
  ImuStream stream;
  for (int i = 0; i < count; ++i) {
    const camera::ImuReading reading = imu.reading(i);
    stream.add({reading.stamp_ns, reading.gyro_rad_s, reading.accel_m_s2});
  }
  return stream;
}

ImuSample sample_at(std::int64_t stamp_ns) {
  return {stamp_ns, Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0, 9.8)};
}

TEST(Preintegration, of_perfect_readings_is_the_true_motion) {
  const CameraPath path(CameraMotion::kHandHeld, 3);
  const auto T = [&](double t_s) { return path.T_world_camera(t_s); };
  const ImuStream stream = readings(SyntheticImu(T, perfect(), 1), 500);
  // Neither end is at a sample.
  const double from_s = 0.5013, to_s = 1.5021, dt_s = to_s - from_s, h_s = 1e-4;
  const auto motion = stream.integrate(std::llround(from_s * 1e9), std::llround(to_s * 1e9), {}, kNoise);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->duration_s(), dt_s, 1e-9);
  const Eigen::Isometry3d first = T(from_s), last = T(to_s);
  const auto velocity = [&](double t_s) {
    return Eigen::Vector3d((T(t_s + h_s).translation() - T(t_s - h_s).translation()) / (2 * h_s));
  };
  EXPECT_LT(geometry::so3_log((first.linear().transpose() * last.linear()).transpose() * motion->rotation()).norm(),
            2e-4);
  const Eigen::Vector3d gained = first.linear() * motion->velocity() + kGravity * dt_s;
  EXPECT_LT((velocity(from_s) + gained - velocity(to_s)).norm(), 3e-3) << "m/s";
  const Eigen::Vector3d end = first.translation() + velocity(from_s) * dt_s + 0.5 * kGravity * dt_s * dt_s +
                              first.linear() * motion->position();
  EXPECT_LT((end - last.translation()).norm(), 2e-3) << "m";
}

TEST(Preintegration, bias_jacobian_predicts_what_another_bias_gives) {
  const CameraPath path(CameraMotion::kHandHeld, 4);
  const ImuStream stream =
      readings(SyntheticImu([&](double t_s) { return path.T_world_camera(t_s); }, SyntheticImu::Options(), 1), 300);
  const ImuBias zero, other{{0.004, -0.003, 0.002}, {0.03, 0.02, -0.04}};
  const auto first = stream.integrate(100 * kMs, 1100 * kMs, zero, kNoise);
  const auto again = stream.integrate(100 * kMs, 1100 * kMs, other, kNoise);
  ASSERT_TRUE(first && again);
  geometry::Vector6d change;
  change << other.gyro_rad_s, other.accel_m_s2;
  const Eigen::Matrix<double, 9, 1> effect = first->bias_jacobian() * change;
  const Eigen::Matrix3d rotation = first->rotation() * geometry::so3_exp(effect.head<3>());
  EXPECT_LT(geometry::so3_log(rotation.transpose() * again->rotation()).norm(), 2e-5);
  EXPECT_LT((first->velocity() + effect.segment<3>(3) - again->velocity()).norm(), 5e-4);
  EXPECT_LT((first->position() + effect.tail<3>() - again->position()).norm(), 3e-4);
  EXPECT_GT((first->position() - again->position()).norm(), 5e-3) << "the biases have no effect";
}

TEST(Preintegration, covariance_is_that_of_many_runs) {
  constexpr int kRuns = 400, kSteps = 200;
  constexpr double kDt_s = 0.005;
  const Eigen::Vector3d gyro(0.3, -0.2, 0.5), accel(1, -2, 9);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto noisy = [&](const Eigen::Vector3d& value, double density) {
    return Eigen::Vector3d(value + density / std::sqrt(kDt_s) *
                                       Eigen::Vector3d{normal(random), normal(random), normal(random)});
  };
  Preintegration truth({}, kNoise);
  for (int i = 0; i < kSteps; ++i) truth.add(gyro, accel, kDt_s);
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    Preintegration motion({}, kNoise);
    for (int i = 0; i < kSteps; ++i) {
      motion.add(noisy(gyro, kNoise.gyro_rad_s_rthz), noisy(accel, kNoise.accel_m_s2_rthz), kDt_s);
    }
    Eigen::Matrix<double, 9, 1> error;
    error << geometry::so3_log(truth.rotation().transpose() * motion.rotation()), motion.velocity() - truth.velocity(),
        motion.position() - truth.position();
    nees += error.dot(truth.covariance().ldlt().solve(error)) / kRuns;
  }
  EXPECT_NEAR(nees, 9, 1.0);
}

TEST(ImuStream, leaves_out_what_cannot_be_used_and_counts_it) {
  ImuStream stream;
  stream.add(sample_at(100 * kMs));
  ImuSample broken = sample_at(105 * kMs);
  broken.gyro_rad_s.y() = std::numeric_limits<double>::quiet_NaN();
  stream.add(broken);
  broken = sample_at(106 * kMs);
  broken.accel_m_s2.x() = 1e6;
  stream.add(broken);
  stream.add(sample_at(100 * kMs));
  stream.add(sample_at(90 * kMs));
  stream.add(sample_at(110 * kMs));
  EXPECT_EQ(stream.counters().taken, 2U);
  EXPECT_EQ(stream.counters().invalid, 2U);
  EXPECT_EQ(stream.counters().doubled, 1U);
  EXPECT_EQ(stream.counters().out_of_order, 1U);
  EXPECT_EQ(stream.counters().dropped(), 4U);
  EXPECT_EQ(stream.newest_ns(), 110 * kMs);
}

TEST(ImuStream, knows_nothing_across_a_pause) {
  ImuStream stream;
  for (int i = 0; i < 100; ++i) stream.add(sample_at(i * 5 * kMs));
  for (int i = 0; i < 100; ++i) stream.add(sample_at(1500 * kMs + i * 5 * kMs));
  EXPECT_EQ(stream.counters().gaps, 1U);
  EXPECT_TRUE(stream.integrate(100 * kMs, 400 * kMs, {}, kNoise));
  EXPECT_TRUE(stream.integrate(1600 * kMs, 1990 * kMs, {}, kNoise));
  EXPECT_FALSE(stream.integrate(400 * kMs, 1600 * kMs, {}, kNoise));
  EXPECT_FALSE(stream.integrate(480 * kMs, 700 * kMs, {}, kNoise));
  EXPECT_FALSE(stream.integrate(1900 * kMs, 2200 * kMs, {}, kNoise)) << "200 ms behind the last sample";
  EXPECT_TRUE(stream.integrate(1900 * kMs, 2050 * kMs, {}, kNoise)) << "the last sample is held for a moment";
  EXPECT_FALSE(stream.integrate(400 * kMs, 400 * kMs, {}, kNoise));
}

TEST(ImuStream, follows_a_clock_that_was_set) {
  ImuStream stream;
  for (int i = 0; i < 100; ++i) stream.add(sample_at(3'600'000 * kMs + i * 5 * kMs));
  for (int i = 0; i < 100; ++i) stream.add(sample_at(1000 * kMs + i * 5 * kMs));  // an hour back
  EXPECT_EQ(stream.counters().clock_jumps, 1U);
  EXPECT_EQ(stream.newest_ns(), 1495 * kMs);
  stream.add(sample_at(7'200'000 * kMs));  // and ahead
  EXPECT_EQ(stream.counters().clock_jumps, 2U);
  EXPECT_EQ(stream.newest_ns(), 7'200'000 * kMs);
}

TEST(ImuStream, keeps_a_bounded_number_of_samples) {
  ImuStream stream;
  for (std::size_t i = 0; i < ImuStream::kMax + 5; ++i) stream.add(sample_at(static_cast<std::int64_t>(i) * kMs));
  EXPECT_EQ(stream.counters().overflowed, 5U);
}

TEST(Rest, shows_which_way_is_up) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&] { return Eigen::Vector3d{normal(random), normal(random), normal(random)}; };
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.95, -0.2).normalized();
  ImuStream stream;
  for (int i = 0; i < 200; ++i) {
    stream.add({i * 5 * kMs, Eigen::Vector3d(0.008, 0, -0.004) + 0.0025 * noise(), 9.80665 * up + 0.02 * noise()});
  }
  const auto found = up_at_rest(stream, 0.5);
  ASSERT_TRUE(found);
  EXPECT_LT(std::acos(found->dot(up)), 0.0005) << "rad";
  EXPECT_FALSE(up_at_rest(stream, 1.5)) << "it has not rested for so long";
  stream.add({1000 * kMs, Eigen::Vector3d(0.4, 0, 0), 9.80665 * up});
  EXPECT_FALSE(up_at_rest(stream, 0.5)) << "it moves";
}

TEST(Rest, is_not_a_steady_turn_or_a_fall) {
  ImuStream turning, falling;
  for (int i = 0; i < 200; ++i) {
    turning.add({i * 5 * kMs, Eigen::Vector3d(0, 0.5, 0), Eigen::Vector3d(0, 9.81, 0)});
    falling.add({i * 5 * kMs, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0.1, 0)});
  }
  EXPECT_FALSE(up_at_rest(turning, 0.5));
  EXPECT_FALSE(up_at_rest(falling, 0.5));
  EXPECT_FALSE(up_at_rest(ImuStream(), 0.5));
}

}  // namespace
}  // namespace rtd::inertial
