// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/inertial/motion_prior.hpp"

#include <cmath>

#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

constexpr std::int64_t kKept_ns = 2'000'000'000;  // of samples, for the rest
constexpr double kRest_s = 0.5;

}  // namespace

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

void MotionPrior::believe(const PredictedPose& measured) {
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
