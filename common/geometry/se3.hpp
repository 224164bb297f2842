// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace rtd::geometry {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;  ///< of messages

/// [v]x, so that skew(v) * w = v x w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation vector (rad) -> rotation matrix; Rodrigues, exact near zero.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& rotation_vector);
/// Rotation matrix -> rotation vector (rad), angle in [0, pi].
Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation);

/// Left Jacobian of SO(3), V in se3_exp([rho; phi]) = (so3_exp(phi), V rho): d(so3_exp(phi) v) = -[so3_exp(phi) v]x V
/// dphi.
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi);

/// Twist [translation part rho; rotation vector phi] (m, rad) -> rigid transform, docs/theory/se3.md Eq. (2).
Eigen::Isometry3d se3_exp(const Vector6d& twist);
/// Inverse of se3_exp.
Vector6d se3_log(const Eigen::Isometry3d& T);

/// Ad of a transform: T Exp(d) T^-1 = Exp(Ad d), and the twist of one point of a rigid body -> that of another, both in
/// their own axes. docs/theory/se3.md.
Matrix6d adjoint(const Eigen::Isometry3d& T);
/// Both halves of a twist, or of an error (translation, rotation), turned into other axes.
Matrix6d block_rotation(const Eigen::Matrix3d& rotation);
/// What an error (translation, rotation about the point) of one point of a rigid body means `offset` (m) from it, in
/// the same axes: rotation swings the translation.
Matrix6d lever_arm(const Eigen::Vector3d& offset);

/// From one pose to another: way and turn in the world, the errors that covariances (x y z rx ry rz) are of.
Vector6d pose_difference(const Eigen::Isometry3d& T_world_from, const Eigen::Isometry3d& T_world_to);
/// Standard deviation in the direction in which it is largest.
double largest_sigma(const Eigen::Matrix3d& covariance);

/// Angle of the rotation part (rad), in [0, pi].
double rotation_angle_rad(const Eigen::Isometry3d& T);
/// T with its rotation made orthonormal again (drift of long products).
Eigen::Isometry3d normalized(const Eigen::Isometry3d& T);

}  // namespace rtd::geometry
