// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/inertial/motion_prior.hpp"

#include <algorithm>
#include <cmath>

#include "common/inertial/preintegration.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kMaxWheelSamples = 4096;

/// The pose a share of the way from one to the other; beyond 1 the motion continues.
Eigen::Isometry3d between(const Eigen::Isometry3d& T_a, const Eigen::Isometry3d& T_b, double share) {
  return T_a * geometry::se3_exp(share * geometry::se3_log(T_a.inverse() * T_b));
}

/// A base that is put elsewhere, or odometry that began again.
bool is_jump(const WheelSample& before, const WheelSample& sample) {
  constexpr double kMost_m_s = 20, kMost_rad_s = 30, kAlways_m = 0.05;
  const double gap_s = inertial::seconds_between(before.stamp_ns, sample.stamp_ns);
  const Eigen::Isometry3d T = before.T_odom_base.inverse() * sample.T_odom_base;
  return T.translation().norm() > kMost_m_s * gap_s + kAlways_m ||
         geometry::rotation_angle_rad(T) > kMost_rad_s * gap_s + kAlways_m;
}

constexpr std::int64_t kKept_ns = 2'000'000'000;  // of samples, for the rest
constexpr double kRest_s = 0.5;

}  // namespace

void WheelStream::add(const WheelSample& sample) {
  constexpr int kStraysOfAJump = 20;
  const bool finite = sample.T_odom_base.matrix().allFinite() && std::isfinite(sample.speed_variance) &&
                      std::isfinite(sample.turning_variance);
  if (!finite || std::abs(sample.T_odom_base.linear().determinant() - 1) > 0.01) {
    ++counters_.invalid;
    return;
  }
  if (!samples_.empty() && sample.stamp_ns <= samples_.back().stamp_ns) {
    ++counters_.out_of_order;
    if (++strays_ < kStraysOfAJump) return;
    ++counters_.jumps;  // the clock was set back
    samples_.clear();
  }
  strays_ = 0;
  if (!samples_.empty()) {
    if (inertial::seconds_between(samples_.back().stamp_ns, sample.stamp_ns) > kMaxGap_s) ++counters_.gaps;
    if (is_jump(samples_.back(), sample)) {
      ++counters_.jumps;
      samples_.clear();
    }
  }
  if (samples_.size() >= kMaxWheelSamples) samples_.pop_front();
  ++counters_.taken;
  samples_.push_back(sample);
}

std::optional<Eigen::Isometry3d> WheelStream::pose_at(std::int64_t stamp_ns) const {
  const auto before = [](const WheelSample& sample, std::int64_t ns) { return sample.stamp_ns < ns; };
  auto next = std::lower_bound(samples_.begin(), samples_.end(), stamp_ns, before);
  if (next != samples_.end() && next->stamp_ns == stamp_ns) return next->T_odom_base;
  if (next == samples_.begin() || samples_.size() < 2) return std::nullopt;
  if (next == samples_.end()) {
    if (inertial::seconds_between(samples_.back().stamp_ns, stamp_ns) > kMaxGap_s) return std::nullopt;
    --next;
  }
  const WheelSample &a = *std::prev(next), &b = *next;
  if (inertial::seconds_between(a.stamp_ns, b.stamp_ns) > kMaxGap_s) return std::nullopt;
  return between(a.T_odom_base, b.T_odom_base,
                 inertial::seconds_between(a.stamp_ns, stamp_ns) / inertial::seconds_between(a.stamp_ns, b.stamp_ns));
}

std::optional<WheelMotion> WheelStream::motion(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto T_odom_first = pose_at(from_ns), T_odom_last = pose_at(to_ns);
  if (!T_odom_first || !T_odom_last || to_ns <= from_ns) return std::nullopt;
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const bool inside = samples_[i].stamp_ns > from_ns && samples_[i - 1].stamp_ns < to_ns;
    if (inside && inertial::seconds_between(samples_[i - 1].stamp_ns, samples_[i].stamp_ns) > kMaxGap_s)
      return std::nullopt;
  }
  WheelMotion motion;
  motion.T_first_last = T_odom_first->inverse() * *T_odom_last;
  motion.covariance = covariance_of(motion.T_first_last, inertial::seconds_between(from_ns, to_ns));
  return motion;
}

/// Wheels slip with the way, or as the messages say if that is more.
geometry::Matrix6d WheelStream::covariance_of(const Eigen::Isometry3d& T_first_last, double duration_s) const {
  const double way_m = T_first_last.translation().norm(), turn_rad = geometry::rotation_angle_rad(T_first_last);
  const WheelSample& newest = samples_.back();
  const auto square = [](double x) { return x * x; };
  const double way = square(config_.distance_share * way_m) + square(config_.still_m);
  const double turn = square(config_.turn_share * turn_rad) + square(config_.turn_rad_m * way_m);
  const double off_plane = square(config_.off_plane_share * way_m);
  const double way_variance = std::max(way, newest.speed_variance * square(duration_s));
  const double turn_variance = std::max(turn, newest.turning_variance * square(duration_s));
  geometry::Vector6d variances;
  constexpr double kLeast_rad2 = 1e-8;
  variances << way_variance, way_variance, off_plane + square(config_.still_m), off_plane + kLeast_rad2,
      off_plane + kLeast_rad2, turn_variance + kLeast_rad2;
  return variances.asDiagonal();
}

void WheelStream::forget_before(std::int64_t stamp_ns) {
  while (samples_.size() > 2 && samples_[1].stamp_ns <= stamp_ns) samples_.pop_front();
}

MotionPrior::MotionPrior(const SlamConfig& config)
    : config_(config),
      T_imu_camera_(config.prior.T_camera_imu.inverse()),
      T_imu_base_(T_imu_camera_ * config.prior.T_base_camera.inverse()),
      wheels_(config.wheel) {}

void MotionPrior::add(inertial::ImuSample sample) {
  sample.stamp_ns = msg::plus_ns(sample.stamp_ns, msg::ns_of(config_.imu.time_offset_s));
  imu_.add(sample);
}

bool MotionPrior::reaches(std::int64_t stamp_ns) const {
  return (!config_.prior.imu || imu_.newest_ns() >= stamp_ns) &&
         (!config_.prior.wheels || wheels_.newest_ns() >= stamp_ns);
}

std::optional<PredictedPose> MotionPrior::advance(std::int64_t stamp_ns) {
  if (now_ns_ != 0 && stamp_ns <= now_ns_) restart();
  before_ns_ = now_ns_;
  now_ns_ = stamp_ns;
  if (filter_) advance_filter(stamp_ns);
  imu_.forget_before(msg::minus_ns(stamp_ns, kKept_ns));
  wheels_.forget_before(msg::minus_ns(last_ns_ == 0 ? stamp_ns : last_ns_, kKept_ns));
  return expected();
}

/// With the bias as far as it is known. Before the filter is ready it has hardly seen a turn.
std::optional<inertial::CameraTurn> MotionPrior::turn_since(std::int64_t from_ns) const {
  constexpr double kScaleError = 0.01, kLeastBias_rad_s = 0.002;  // poses that it was learnt from share errors
  if (!config_.prior.imu) return std::nullopt;
  const bool known = filter_ && filter_->ready();
  const auto motion = imu_.integrate(from_ns, now_ns_, known ? filter_->bias() : inertial::ImuBias{},
                                     {config_.imu.gyro_rad_s_rthz, config_.imu.accel_m_s2_rthz});
  if (!motion) return std::nullopt;
  Eigen::Matrix3d bias =
      std::pow(known ? kLeastBias_rad_s : config_.imu.gyro_bias_rad_s, 2) * Eigen::Matrix3d::Identity();
  if (known) bias += filter_->gyro_bias_covariance();
  return inertial::turn_of_camera(*motion, config_.prior.T_camera_imu.linear(), {bias, kScaleError});
}

void MotionPrior::advance_filter(std::int64_t stamp_ns) {
  const auto motion =
      imu_.integrate(before_ns_, stamp_ns, filter_->bias(), {config_.imu.gyro_rad_s_rthz, config_.imu.accel_m_s2_rthz});
  if (!motion) {
    filter_->predict_blind(msg::minus_s(stamp_ns, before_ns_));
    return;
  }
  const Eigen::Isometry3d T_world_imu_before = filter_->state().T_world_imu;
  filter_->predict(*motion);
  if (config_.prior.wheels) use_wheels(*motion, T_world_imu_before, before_ns_);
}

/// The distance that the base covers gives the velocity; turns are better known by the gyroscope.
void MotionPrior::use_wheels(const inertial::Preintegration& motion, const Eigen::Isometry3d& T_world_imu_before,
                             std::int64_t from_ns) {
  const auto way = wheels_.motion(from_ns, now_ns_);
  if (!way) return;
  const Eigen::Matrix3d R_world_base = (T_world_imu_before * T_imu_base_).linear();
  filter_->update_way(motion, T_world_imu_before, T_imu_base_.translation(),
                      R_world_base * way->T_first_last.translation(),
                      R_world_base * way->covariance.topLeftCorner<3, 3>() * R_world_base.transpose());
}

/// From the last measured pose on, docs/theory/inertial.md Eq. (11).
std::optional<PredictedPose> MotionPrior::by_wheels() const {
  if (!config_.prior.wheels || !last_ || elsewhere_) return std::nullopt;
  const auto motion = wheels_.motion(last_ns_, now_ns_);
  if (!motion) return std::nullopt;
  const Eigen::Isometry3d& T_base_camera = config_.prior.T_base_camera;
  const Eigen::Isometry3d T_world_base = last_->T_world_camera * T_base_camera.inverse();
  PredictedPose pose;
  pose.T_world_camera = geometry::normalized(T_world_base * motion->T_first_last * T_base_camera);
  const auto lever = [&](const Eigen::Vector3d& from) {
    return geometry::lever_arm(pose.T_world_camera.translation() - from);
  };
  // Errors of the last pose swing the whole way; those of the motion happen, on average, at its middle.
  const geometry::Matrix6d of_last = lever(last_->T_world_camera.translation());
  const geometry::Matrix6d of_way =
      lever(0.5 * (T_world_base.translation() + (T_world_base * motion->T_first_last).translation()));
  const geometry::Matrix6d R = geometry::block_rotation(T_world_base.linear());
  pose.covariance = of_last * last_->covariance * of_last.transpose() +
                    of_way * (R * motion->covariance * R.transpose()) * of_way.transpose();
  return pose;
}

std::optional<PredictedPose> MotionPrior::expected() const {
  if (elsewhere_) return std::nullopt;
  if (filter_ && filter_->ready()) return filter_->camera();
  return by_wheels();
}

std::optional<PredictedPose> MotionPrior::doubted() const {
  return !elsewhere_ && filter_ && filter_->ready() ? filter_->doubted_camera() : expected();
}

void MotionPrior::doubt() {
  if (!elsewhere_ && filter_ && filter_->ready()) filter_->doubt();
}

void MotionPrior::update(const PredictedPose& measured) {
  correct(measured);
  if (filter_) filter_->trust();
}

std::optional<PredictedPose> MotionPrior::correct(const PredictedPose& measured) {
  if (elsewhere_) {
    relocate(measured);
    return measured;
  }
  last_ = measured;
  last_ns_ = now_ns_;
  filter_ ? filter_->update(measured) : begin_filter(measured);
  return expected();
}

void MotionPrior::relocate(const PredictedPose& measured) {
  elsewhere_ = false;
  last_ = measured;
  last_ns_ = now_ns_;
  filter_ ? filter_->relocate(measured) : begin_filter(measured);
}

void MotionPrior::remember(std::uint64_t seq) {
  if (filter_ && filter_->ready()) filter_->remember(seq);
}

std::vector<PoseCorrection> MotionPrior::take_corrections() {
  return filter_ ? filter_->take_corrections() : std::vector<PoseCorrection>();
}

/// From the second frame on: until then nothing says which way is up.
void MotionPrior::begin_filter(const PredictedPose& measured) {
  if (!config_.prior.imu || before_ns_ == 0) return;
  const auto motion = imu_.integrate(before_ns_, now_ns_, {}, {});
  if (motion && motion->velocity().norm() > 0)
    filter_.emplace(config_.imu, T_imu_camera_, measured, motion->velocity());
}

void MotionPrior::move(const Eigen::Isometry3d& T_new_old) {
  if (filter_) filter_->move(T_new_old);
  if (last_) last_->T_world_camera = geometry::normalized(T_new_old * last_->T_world_camera);
}

void MotionPrior::restart() {
  filter_.reset();
  last_.reset();
  now_ns_ = before_ns_ = last_ns_ = 0;
}

std::optional<Eigen::Vector3d> MotionPrior::up_in_camera() const {
  if (const auto up_imu = inertial::up_at_rest(imu_, kRest_s)) return config_.prior.T_camera_imu.linear() * *up_imu;
  if (!filter_ || !filter_->ready()) return std::nullopt;
  const InertialState& state = filter_->state();
  const Eigen::Vector3d up_imu = -(state.T_world_imu.linear().transpose() * state.gravity_m_s2).normalized();
  return config_.prior.T_camera_imu.linear() * up_imu;
}

}  // namespace rtd::slam
