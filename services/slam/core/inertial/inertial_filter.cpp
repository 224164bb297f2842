// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/inertial/inertial_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rtd::slam {
namespace {

using geometry::skew;
using geometry::so3_exp;
using geometry::so3_log;
using Matrix3 = Eigen::Matrix3d;

/// Places in the error state.
constexpr int kRotation = 0, kPosition = 3, kVelocity = 6, kGyroBias = 9, kAccelBias = 12, kGravity = 15;
constexpr double kUnknownSpeed_m_s = 1.0;  ///< of a hand or a robot
constexpr double kUnknownUp_rad = 0.3;     ///< of an accelerometer that moves
constexpr int kFewPoses = 10;
constexpr int kSmoothing = 30;  ///< poses that correct the predicted ones before

Eigen::Isometry3d pose_of(const Matrix3& R, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = p;
  return T;
}

/// Products for any size: with fixed ones, Eigen is compiled once more for each combination.
using AnyMatrix = Eigen::Ref<const Eigen::MatrixXd>;
Eigen::MatrixXd product(const AnyMatrix& A, const AnyMatrix& B) {
  return A * B;
}

/// The covariance of A x, where P is that of x.
Eigen::MatrixXd propagated(const AnyMatrix& A, const AnyMatrix& P) {
  return product(product(A, P), A.transpose());
}

}  // namespace

InertialFilter::InertialFilter(const ImuConfig& config, const Eigen::Isometry3d& T_imu_camera,
                               const PredictedPose& camera, const Eigen::Vector3d& accel_m_s2)
    : config_(config), T_imu_camera_(T_imu_camera) {
  state_.T_world_imu = camera.T_world_camera * T_imu_camera.inverse();
  const Eigen::Vector3d up = state_.T_world_imu.linear() * accel_m_s2;
  state_.gravity_m_s2 = -config_.gravity_m_s2 * up.normalized();
  P_.block<3, 3>(kVelocity, kVelocity).diagonal().setConstant(kUnknownSpeed_m_s * kUnknownSpeed_m_s);
  P_.block<3, 3>(kGyroBias, kGyroBias).diagonal().setConstant(std::pow(config_.gyro_bias_rad_s, 2));
  P_.block<3, 3>(kAccelBias, kAccelBias).diagonal().setConstant(std::pow(config_.accel_bias_m_s2, 2));
  P_.block<3, 3>(kGravity, kGravity).diagonal().setConstant(kUnknownUp_rad * kUnknownUp_rad);
  relocate(camera);
}

/// docs/theory/inertial.md Eq. (6), (7).
void InertialFilter::predict(const inertial::Preintegration& motion) {
  const double dt_s = motion.duration_s();
  const Matrix3 R = state_.T_world_imu.linear();
  const Matrix3 R_next = R * motion.rotation();
  const Eigen::Vector3d gained = R * motion.velocity(), moved = R * motion.position();
  const Eigen::Vector3d g = state_.gravity_m_s2;
  const inertial::Preintegration::Matrix96d& J = motion.bias_jacobian();

  Matrix18d F = Matrix18d::Identity();
  F.block<3, 6>(kRotation, kGyroBias) = R_next * J.topRows<3>();
  F.block<3, 3>(kVelocity, kRotation) = -skew(gained);
  F.block<3, 6>(kVelocity, kGyroBias) = R * J.middleRows<3>(3);
  F.block<3, 3>(kVelocity, kGravity) = -skew(g) * dt_s;
  F.block<3, 3>(kPosition, kRotation) = -skew(moved);
  F.block<3, 3>(kPosition, kVelocity) = dt_s * Matrix3::Identity();
  F.block<3, 6>(kPosition, kGyroBias) = R * J.bottomRows<3>();
  F.block<3, 3>(kPosition, kGravity) = -0.5 * dt_s * dt_s * skew(g);

  Eigen::Matrix<double, 18, 9> G = Eigen::Matrix<double, 18, 9>::Zero();
  G.block<3, 3>(kRotation, 0) = R_next;
  G.block<3, 3>(kVelocity, 3) = R;
  G.block<3, 3>(kPosition, 6) = R;
  P_ = propagated(F, P_) + propagated(G, motion.covariance());
  P_.diagonal().segment<3>(kGyroBias).array() += std::pow(config_.gyro_walk_rad_s2_rthz, 2) * dt_s;
  P_.diagonal().segment<3>(kAccelBias).array() += std::pow(config_.accel_walk_m_s3_rthz, 2) * dt_s;

  const Matrix18d F_transposed = F.transpose();
  for (PredictedFrame& frame : predicted_)
    frame.covariance_with_state = product(frame.covariance_with_state, F_transposed);
  by_learnt_ = product(F, by_learnt_);

  const Eigen::Vector3d p =
      state_.T_world_imu.translation() + state_.velocity_m_s * dt_s + 0.5 * dt_s * dt_s * g + moved;
  state_.velocity_m_s += g * dt_s + gained;
  state_.T_world_imu = geometry::normalized(pose_of(R_next, p));
}

void InertialFilter::predict_blind(double gap_s) {
  constexpr double kTurning_rad_s = 1.0;
  const double way_m = kUnknownSpeed_m_s * gap_s, turn_rad = kTurning_rad_s * gap_s;
  P_.topRows<9>().setZero();
  P_.leftCols<9>().setZero();
  P_.diagonal().segment<3>(kRotation).setConstant(turn_rad * turn_rad);
  P_.diagonal().segment<3>(kPosition).setConstant(way_m * way_m);
  P_.diagonal().segment<3>(kVelocity).setConstant(kUnknownSpeed_m_s * kUnknownSpeed_m_s);
  P_.diagonal().segment<3>(kGyroBias).array() += std::pow(config_.gyro_walk_rad_s2_rthz, 2) * gap_s;
  P_.diagonal().segment<3>(kAccelBias).array() += std::pow(config_.accel_walk_m_s3_rthz, 2) * gap_s;
  state_.velocity_m_s.setZero();
  predicted_.clear();
  measured_ = 0;
  ready_ = false;
  trust();
}

/// d(position, rotation of the camera) by the error state, Eq. (8).
Eigen::Matrix<double, 6, 18> InertialFilter::camera_jacobian() const {
  Eigen::Matrix<double, 6, 18> H = Eigen::Matrix<double, 6, 18>::Zero();
  H.block<3, 3>(0, kPosition).setIdentity();
  H.block<3, 3>(0, kRotation) = -skew(state_.T_world_imu.linear() * T_imu_camera_.translation());
  H.block<3, 3>(3, kRotation).setIdentity();
  return H;
}

Eigen::Matrix3d InertialFilter::gyro_bias_covariance() const {
  return P_.block<3, 3>(kGyroBias, kGyroBias);
}

PredictedPose InertialFilter::camera() const {
  const Eigen::Matrix<double, 6, 18> H = camera_jacobian();
  return {state_.T_world_imu * T_imu_camera_, propagated(H, P_)};
}

/// What must be known of them before anything is predicted, and of the accelerometer's bias at first.
Eigen::Matrix<double, 9, 1> InertialFilter::learnt_variances() const {
  Eigen::Matrix<double, 9, 1> sigmas;
  sigmas << Eigen::Vector3d::Constant(config_.ready_m_s), Eigen::Vector3d::Constant(config_.ready_rad_s),
      Eigen::Vector3d::Constant(config_.accel_bias_m_s2);
  return sigmas.cwiseAbs2();
}

PredictedPose InertialFilter::doubted_camera() const {
  PredictedPose pose = camera();
  const Eigen::MatrixXd of_learnt = learnt_variances().asDiagonal();
  pose.covariance += propagated(product(camera_jacobian(), by_learnt_), of_learnt);
  return pose;
}

void InertialFilter::doubt() {
  const Eigen::MatrixXd error = learnt_variances().asDiagonal() * by_learnt_.transpose();
  P_ += product(by_learnt_, error);
  for (PredictedFrame& frame : predicted_) frame.covariance_with_state += product(frame.by_learnt, error);
}

void InertialFilter::trust() {
  by_learnt_.setZero();
  by_learnt_.middleRows<9>(kVelocity).setIdentity();
  for (PredictedFrame& frame : predicted_) frame.by_learnt.setZero();
}

/// The Kalman update in Joseph's form, and the error put into the state. Eq. (9).
void InertialFilter::correct(const Eigen::MatrixXd& H, const Eigen::VectorXd& residual, const Eigen::MatrixXd& R) {
  const Eigen::MatrixXd S = propagated(H, P_) + R;
  const auto of_S = S.ldlt();
  const Eigen::MatrixXd K = of_S.solve(product(H, P_)).transpose();
  const Matrix18d keep = Matrix18d::Identity() - product(K, H);
  const Matrix18d keep_transposed = keep.transpose();
  const Eigen::MatrixXd surprise = product(H.transpose(), of_S.solve(residual));
  for (PredictedFrame& frame : predicted_) {
    const geometry::Vector6d error = product(frame.covariance_with_state, surprise);
    frame.T_world_camera = geometry::normalized(pose_of(so3_exp(error.tail<3>()) * frame.T_world_camera.linear(),
                                                        frame.T_world_camera.translation() + error.head<3>()));
    frame.covariance_with_state = product(frame.covariance_with_state, keep_transposed);
  }
  by_learnt_ = product(keep, by_learnt_);
  P_ = propagated(keep, P_) + propagated(K, R);
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  const Eigen::Matrix<double, 18, 1> error = product(K, residual);
  state_.T_world_imu = geometry::normalized(pose_of(so3_exp(error.segment<3>(kRotation)) * state_.T_world_imu.linear(),
                                                    state_.T_world_imu.translation() + error.segment<3>(kPosition)));
  state_.velocity_m_s += error.segment<3>(kVelocity);
  state_.bias.gyro_rad_s += error.segment<3>(kGyroBias);
  state_.bias.accel_m_s2 += error.segment<3>(kAccelBias);
  state_.gravity_m_s2 = so3_exp(error.segment<3>(kGravity)) * state_.gravity_m_s2;
}

void InertialFilter::remember(std::uint64_t seq) {
  const Eigen::Isometry3d T_world_camera = state_.T_world_imu * T_imu_camera_;
  const Eigen::Matrix<double, 6, 18> H = camera_jacobian();
  predicted_.push_back({seq, T_world_camera, T_world_camera, product(H, P_), product(H, by_learnt_)});
  measured_since_predicted_ = 0;
}

std::vector<PoseCorrection> InertialFilter::take_corrections() {
  std::vector<PoseCorrection> corrections;
  for (PredictedFrame& frame : predicted_) {
    corrections.push_back({frame.seq, geometry::normalized(frame.T_world_claimed.inverse() * frame.T_world_camera)});
    frame.T_world_claimed = frame.T_world_camera;
  }
  if (measured_since_predicted_ >= kSmoothing) predicted_.clear();
  return corrections;
}

void InertialFilter::update(const PredictedPose& measured) {
  ++measured_since_predicted_;
  const PredictedPose expected = camera();
  const Matrix3 R_error = measured.T_world_camera.linear() * expected.T_world_camera.linear().transpose();
  geometry::Vector6d residual;
  residual << measured.T_world_camera.translation() - expected.T_world_camera.translation(), so3_log(R_error);
  const double distance2 = pose_distance2(expected, measured);
  correct(camera_jacobian(), residual, std::max(1.0, distance2 / kMaxPoseDistance2) * measured.covariance);
  const auto sigma = [this](int place) { return std::sqrt(P_.diagonal().segment<3>(place).maxCoeff()); };
  ready_ = ready_ ||
           (++measured_ >= kFewPoses && sigma(kVelocity) < config_.ready_m_s && sigma(kGyroBias) < config_.ready_rad_s);
}

/// Eq. (12): the way is linear in the velocity at its end.
void InertialFilter::update_way(const inertial::Preintegration& motion, const Eigen::Isometry3d& T_world_imu_before,
                                const Eigen::Vector3d& point_m, const Eigen::Vector3d& way_world_m,
                                const Eigen::Matrix3d& covariance) {
  const double dt_s = motion.duration_s();
  const Matrix3 R_before = T_world_imu_before.linear();
  const Eigen::Vector3d g = state_.gravity_m_s2;
  const Eigen::Vector3d way_of_imu_m =
      state_.velocity_m_s * dt_s - 0.5 * dt_s * dt_s * g - R_before * (motion.velocity() * dt_s - motion.position());
  const Eigen::Vector3d swing_m = (state_.T_world_imu.linear() - R_before) * point_m;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3, 18);
  H.block<3, 3>(0, kVelocity) = dt_s * Matrix3::Identity();
  H.block<3, 3>(0, kRotation) = -skew(way_world_m);  // it was measured in axes that turn with the IMU
  correct(H, way_world_m - way_of_imu_m - swing_m, covariance);
}

void InertialFilter::move(const Eigen::Isometry3d& T_new_old) {
  const Matrix3 R = T_new_old.linear();
  state_.T_world_imu = geometry::normalized(T_new_old * state_.T_world_imu);
  state_.velocity_m_s = R * state_.velocity_m_s;
  state_.gravity_m_s2 = R * state_.gravity_m_s2;
  Matrix18d A = Matrix18d::Identity();
  for (const int place : {kRotation, kPosition, kVelocity, kGravity}) A.block<3, 3>(place, place) = R;
  P_ = propagated(A, P_);
  by_learnt_ = product(A, by_learnt_);
  const Matrix18d A_transposed = A.transpose();
  const geometry::Matrix6d of_pose = A.topLeftCorner<6, 6>();  // both rotations are R
  for (PredictedFrame& frame : predicted_) {
    frame.T_world_claimed = geometry::normalized(T_new_old * frame.T_world_claimed);
    frame.T_world_camera = geometry::normalized(T_new_old * frame.T_world_camera);
    frame.covariance_with_state = product(product(of_pose, frame.covariance_with_state), A_transposed);
    frame.by_learnt = product(of_pose, frame.by_learnt);
  }
}

void InertialFilter::relocate(const PredictedPose& measured) {
  const PredictedPose expected = camera();
  predicted_.clear();
  move(measured.T_world_camera * expected.T_world_camera.inverse());
  // Errors of the pose are those of the measurement, and no longer those of the motion.
  P_.topRows<6>().setZero();
  P_.leftCols<6>().setZero();
  const Matrix3 lever = skew(state_.T_world_imu.linear() * T_imu_camera_.translation());
  geometry::Matrix6d J = geometry::Matrix6d::Zero();  // (rotation, position) of the IMU by (position, rotation)
  J.block<3, 3>(0, 3).setIdentity();
  J.block<3, 3>(3, 0).setIdentity();
  J.block<3, 3>(3, 3) = lever;
  P_.topLeftCorner<6, 6>() = J * measured.covariance * J.transpose();
  // What turned the pose turned gravity and velocity by guess.
  P_.block<3, 3>(kGravity, kGravity) += measured.covariance.bottomRightCorner<3, 3>();
  trust();
}

}  // namespace rtd::slam
