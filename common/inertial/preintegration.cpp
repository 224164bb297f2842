// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/inertial/preintegration.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/se3.hpp"

namespace rtd::inertial {
namespace {

using geometry::skew;
using geometry::so3_exp;

ImuSample interpolate(const ImuSample& a, const ImuSample& b, std::int64_t stamp_ns) {
  const double share = seconds_between(a.stamp_ns, stamp_ns) / seconds_between(a.stamp_ns, b.stamp_ns);
  return {stamp_ns, a.gyro_rad_s + share * (b.gyro_rad_s - a.gyro_rad_s),
          a.accel_m_s2 + share * (b.accel_m_s2 - a.accel_m_s2)};
}

bool is_plausible(const ImuSample& sample) {
  constexpr double kMost_rad_s = 70, kMost_m_s2 = 400;  // 4000 deg/s, 40 g
  return sample.gyro_rad_s.allFinite() && sample.accel_m_s2.allFinite() && sample.gyro_rad_s.norm() < kMost_rad_s &&
         sample.accel_m_s2.norm() < kMost_m_s2;
}

}  // namespace

void Preintegration::add(const Eigen::Vector3d& gyro_rad_s, const Eigen::Vector3d& accel_m_s2, double dt_s) {
  const Eigen::Vector3d turn_rad = (gyro_rad_s - bias_.gyro_rad_s) * dt_s;
  const Eigen::Vector3d accel = accel_m_s2 - bias_.accel_m_s2;
  const Eigen::Matrix3d half_turn = so3_exp(0.5 * turn_rad);
  const Eigen::Matrix3d R_first_middle = rotation_ * half_turn;
  const Eigen::Vector3d gained = R_first_middle * accel * dt_s;

  Matrix9d A = Matrix9d::Identity();
  A.block<3, 3>(0, 0) = so3_exp(-turn_rad);
  A.block<3, 3>(3, 0) = -R_first_middle * skew(accel) * half_turn.transpose() * dt_s;
  A.block<3, 3>(6, 0) = 0.5 * dt_s * A.block<3, 3>(3, 0);
  A.block<3, 3>(6, 3) = dt_s * Eigen::Matrix3d::Identity();
  Matrix96d B = Matrix96d::Zero();
  B.block<3, 3>(0, 0) = -geometry::so3_left_jacobian(-turn_rad) * dt_s;  // the right Jacobian
  B.block<3, 3>(3, 3) = -R_first_middle * dt_s;
  B.block<3, 3>(6, 3) = 0.5 * dt_s * B.block<3, 3>(3, 3);

  Eigen::Matrix<double, 6, 1> variance;  // of the mean over dt: white noise enters as a bias does
  variance << Eigen::Vector3d::Constant(noise_.gyro_rad_s_rthz * noise_.gyro_rad_s_rthz / dt_s),
      Eigen::Vector3d::Constant(noise_.accel_m_s2_rthz * noise_.accel_m_s2_rthz / dt_s);
  covariance_ = A * covariance_ * A.transpose() + B * variance.asDiagonal() * B.transpose();
  bias_jacobian_ = A * bias_jacobian_ + B;

  position_ += (velocity_ + 0.5 * gained) * dt_s;
  velocity_ += gained;
  rotation_ = rotation_ * so3_exp(turn_rad);
  duration_s_ += dt_s;
}

void ImuStream::add(const ImuSample& sample) {
  if (!is_plausible(sample)) {
    ++counters_.invalid;
    return;
  }
  if (!follows(sample)) return;
  if (samples_.size() >= kMax) {
    samples_.pop_front();
    ++counters_.overflowed;
  }
  ++counters_.taken;
  samples_.push_back(sample);
}

/// Whether the sample continues from the newest one. A clock that was set shows in many samples, a late one does not.
bool ImuStream::follows(const ImuSample& sample) {
  constexpr int kStraysOfAJump = 20;
  constexpr double kJump_s = 10;
  if (samples_.empty()) return true;
  const double gap_s = seconds_between(samples_.back().stamp_ns, sample.stamp_ns);
  if (gap_s > 0) {
    strays_ = 0;
    if (gap_s > kMaxGap_s) ++counters_.gaps;
    if (gap_s > kJump_s) {
      ++counters_.clock_jumps;
      samples_.clear();
    }
    return true;
  }
  if (++strays_ >= kStraysOfAJump) {
    strays_ = 0;
    ++counters_.clock_jumps;
    samples_.clear();
    return true;
  }
  ++(gap_s == 0 ? counters_.doubled : counters_.out_of_order);
  return false;
}

std::optional<Preintegration> ImuStream::integrate(std::int64_t from_ns, std::int64_t to_ns, const ImuBias& bias,
                                                   const ImuNoise& noise) const {
  if (samples_.empty() || to_ns <= from_ns) return std::nullopt;
  if (seconds_between(from_ns, samples_.front().stamp_ns) > kMaxGap_s) return std::nullopt;
  if (seconds_between(samples_.back().stamp_ns, to_ns) > kMaxGap_s) return std::nullopt;
  Preintegration sum(bias, noise);
  const auto before = [](const ImuSample& sample, std::int64_t stamp_ns) { return sample.stamp_ns < stamp_ns; };
  auto next = std::lower_bound(samples_.begin(), samples_.end(), from_ns, before);
  // What is held beyond the first and the last sample is all that is known.
  ImuSample last = next == samples_.end()     ? samples_.back()
                   : next == samples_.begin() ? samples_.front()
                                              : interpolate(*std::prev(next), *next, from_ns);
  last.stamp_ns = from_ns;
  while (last.stamp_ns < to_ns) {
    ImuSample now = next == samples_.end() ? last : *next;
    if (next != samples_.end()) {
      const std::int64_t previous_ns = next == samples_.begin() ? from_ns : std::prev(next)->stamp_ns;
      if (seconds_between(previous_ns, now.stamp_ns) > kMaxGap_s) return std::nullopt;
      ++next;
    }
    if (now.stamp_ns <= last.stamp_ns && next != samples_.end()) continue;  // a sample at the very beginning
    if (now.stamp_ns <= last.stamp_ns) now.stamp_ns = to_ns;                // held
    if (now.stamp_ns > to_ns) now = interpolate(last, now, to_ns);
    sum.add(0.5 * (last.gyro_rad_s + now.gyro_rad_s), 0.5 * (last.accel_m_s2 + now.accel_m_s2),
            seconds_between(last.stamp_ns, now.stamp_ns));
    last = now;
  }
  return sum;
}

void ImuStream::forget_before(std::int64_t stamp_ns) {
  while (samples_.size() > 1 && samples_[1].stamp_ns <= stamp_ns) samples_.pop_front();
}

std::optional<ImuSample> ImuStream::rest(double min_s) const {
  constexpr double kMost_rad_s = 0.03, kMost_m_s2 = 0.15;  // off the mean: a hand at rest trembles more
  if (samples_.empty()) return std::nullopt;
  ImuSample mean = samples_.back();
  double count = 1;
  std::int64_t oldest_ns = mean.stamp_ns;
  for (auto sample = std::next(samples_.rbegin()); sample != samples_.rend(); ++sample) {
    const bool quiet = (sample->gyro_rad_s - mean.gyro_rad_s).norm() < kMost_rad_s &&
                       (sample->accel_m_s2 - mean.accel_m_s2).norm() < kMost_m_s2 &&
                       seconds_between(sample->stamp_ns, oldest_ns) <= kMaxGap_s;
    if (!quiet) break;
    ++count;
    mean.gyro_rad_s += (sample->gyro_rad_s - mean.gyro_rad_s) / count;
    mean.accel_m_s2 += (sample->accel_m_s2 - mean.accel_m_s2) / count;
    oldest_ns = sample->stamp_ns;
  }
  constexpr double kMaxTurning_rad_s = 0.1, kGravity_m_s2 = 9.81, kMaxOff_m_s2 = 0.5;  // beyond any bias: it moves
  const bool rests = seconds_between(oldest_ns, mean.stamp_ns) >= min_s && mean.gyro_rad_s.norm() < kMaxTurning_rad_s &&
                     std::abs(mean.accel_m_s2.norm() - kGravity_m_s2) < kMaxOff_m_s2;
  return rests ? std::optional(mean) : std::nullopt;
}

std::optional<Eigen::Vector3d> up_at_rest(const ImuStream& samples, double min_s) {
  const auto rest = samples.rest(min_s);
  return rest ? std::optional<Eigen::Vector3d>(rest->accel_m_s2.normalized()) : std::nullopt;
}

CameraTurn turn_of_camera(const Preintegration& motion, const Eigen::Matrix3d& R_camera_imu,
                          const GyroscopeErrors& errors) {
  const Eigen::Matrix3d by_bias = motion.bias_jacobian().topLeftCorner<3, 3>();
  const double scale_rad = errors.scale_error * geometry::so3_log(motion.rotation()).norm();
  const Eigen::Matrix3d covariance = motion.covariance().topLeftCorner<3, 3>() +
                                     by_bias * errors.bias_covariance * by_bias.transpose() +
                                     scale_rad * scale_rad * Eigen::Matrix3d::Identity();
  return {R_camera_imu * motion.rotation() * R_camera_imu.transpose(),
          R_camera_imu * covariance * R_camera_imu.transpose()};
}

}  // namespace rtd::inertial
