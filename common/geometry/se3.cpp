// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/se3.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rtd::geometry {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle < 1e-10) {
    const Eigen::Matrix3d w = skew(rotation_vector);
    return Eigen::Matrix3d::Identity() + w + 0.5 * w * w;
  }
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis{Eigen::Quaterniond(rotation).normalized()};
  return angle_axis.angle() * angle_axis.axis();
}

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi) {
  const double angle2 = phi.squaredNorm();
  const Eigen::Matrix3d phi_x = skew(phi);
  if (angle2 < 1e-12) return Eigen::Matrix3d::Identity() + 0.5 * phi_x + phi_x * phi_x / 6.0;
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / angle2 * phi_x +
         (angle - std::sin(angle)) / (angle2 * angle) * phi_x * phi_x;
}

Eigen::Isometry3d se3_exp(const Vector6d& twist) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = so3_exp(twist.tail<3>());
  T.translation() = so3_left_jacobian(twist.tail<3>()) * twist.head<3>();
  return T;
}

Vector6d se3_log(const Eigen::Isometry3d& T) {
  Vector6d twist;
  twist.tail<3>() = so3_log(T.linear());
  const Eigen::Vector3d phi = twist.tail<3>();
  twist.head<3>() = so3_left_jacobian(phi).partialPivLu().solve(T.translation());
  return twist;
}

Matrix6d adjoint(const Eigen::Isometry3d& T) {
  Matrix6d Ad = block_rotation(T.linear());
  Ad.topRightCorner<3, 3>() = skew(T.translation()) * T.linear();
  return Ad;
}

Matrix6d block_rotation(const Eigen::Matrix3d& rotation) {
  Matrix6d R = Matrix6d::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = rotation;
  return R;
}

Matrix6d lever_arm(const Eigen::Vector3d& offset) {
  Matrix6d lever = Matrix6d::Identity();
  lever.topRightCorner<3, 3>() = -skew(offset);
  return lever;
}

Vector6d pose_difference(const Eigen::Isometry3d& T_world_from, const Eigen::Isometry3d& T_world_to) {
  Vector6d difference;
  difference << T_world_to.translation() - T_world_from.translation(),
      so3_log(T_world_to.linear() * T_world_from.linear().transpose());
  return difference;
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

double rotation_angle_rad(const Eigen::Isometry3d& T) {
  return so3_log(T.linear()).norm();
}

Eigen::Isometry3d normalized(const Eigen::Isometry3d& T) {
  Eigen::Isometry3d result = T;
  result.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return result;
}

}  // namespace rtd::geometry
