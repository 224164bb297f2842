// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/inertial/preintegration.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/map/trajectory.hpp"

namespace rtd::slam {

/// Where the IMU is and what it is wrong by.
struct InertialState {
  Eigen::Isometry3d T_world_imu = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  ///< world
  inertial::ImuBias bias;
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();  ///< world, points down
};

/// Error-state Kalman filter over the pose of an IMU, its velocity, both biases and the direction of gravity in the
/// world: predicted by preintegrated samples, corrected by poses that slam measured. docs/theory/inertial.md, "Filter".
/// Errors are (rotation, position, velocity, gyro bias, accel bias, rotation of gravity), all but the biases in the
/// axes of the world. Deterministic. Not thread-safe.
class InertialFilter {
 public:
  using Matrix18d = Eigen::Matrix<double, 18, 18>;
  using Matrix189d = Eigen::Matrix<double, 18, 9>;

  /// At a measured pose; `accel_m_s2`: what the IMU shows on average there, in its own axes: mostly gravity.
  InertialFilter(const ImuConfig& config, const Eigen::Isometry3d& T_imu_camera, const PredictedPose& camera,
                 const Eigen::Vector3d& accel_m_s2);

  /// The motion since the last call, integrated with bias().
  void predict(const inertial::Preintegration& motion);
  /// The samples since the last call are missing: `gap_s` later the camera may be where a hand has moved it.
  void predict_blind(double gap_s);
  /// slam measured the pose of the camera. Far off the prediction, it is weighed less.
  void update(const PredictedPose& camera);
  /// Mean velocity over the last `motion`, of a point of the IMU's body (IMU axes, m), in the world.
  void update_way(const inertial::Preintegration& motion, const Eigen::Isometry3d& T_world_imu_before,
                  const Eigen::Vector3d& point_m, const Eigen::Vector3d& way_world_m,
                  const Eigen::Matrix3d& covariance);
  /// The map was corrected under the camera: the world moved by this.
  void move(const Eigen::Isometry3d& T_new_old);
  /// slam found the camera elsewhere: pose by measurement; motion, biases and gravity go with it.
  void relocate(const PredictedPose& camera);

  const InertialState& state() const { return state_; }
  const inertial::ImuBias& bias() const { return state_.bias; }
  const Matrix18d& covariance() const { return P_; }
  Eigen::Matrix3d gyro_bias_covariance() const;
  /// The pose of this frame is predicted: what is measured during the next second corrects it. Eq. (14).
  void remember(std::uint64_t seq);
  /// What was found out since the last call.
  std::vector<PoseCorrection> take_corrections();
  /// Pose of the camera with its covariance.
  PredictedPose camera() const;
  /// The same if velocity and biases were known no better at the last trust() than predictions need to begin. Eq. (16).
  PredictedPose doubted_camera() const;
  /// They were not: the next poses correct them.
  void doubt();
  /// The pose is known by what is seen: an error of velocity and biases shows from here on only.
  void trust();
  /// Whether velocity and gyro bias have been known well enough since the last pause to say where the next frames are.
  bool ready() const { return ready_; }

 private:
  struct PredictedFrame {
    std::uint64_t seq;
    Eigen::Isometry3d T_world_claimed, T_world_camera;   ///< as taken last, and as known now
    Eigen::Matrix<double, 6, 18> covariance_with_state;  ///< of (position, rotation) of the camera then
    Eigen::Matrix<double, 6, 9> by_learnt;               ///< the error of that pose, as by_learnt_
  };
  Eigen::Matrix<double, 6, 18> camera_jacobian() const;
  Eigen::Matrix<double, 9, 1> learnt_variances() const;
  void correct(const Eigen::MatrixXd& H, const Eigen::VectorXd& residual, const Eigen::MatrixXd& R);

  ImuConfig config_;
  Eigen::Isometry3d T_imu_camera_;
  InertialState state_;
  Matrix18d P_ = Matrix18d::Zero();
  Matrix189d by_learnt_ = Matrix189d::Zero();  ///< the error by those of velocity and biases at the last trust()
  std::vector<PredictedFrame> predicted_;
  int measured_since_predicted_ = 0;
  int measured_ = 0;  ///< poses since velocity was unknown
  bool ready_ = false;
};

}  // namespace rtd::slam
