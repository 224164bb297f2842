// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/pose_solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rtd::vision {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;

/// Squared residual of a point that a trial step pushed behind the camera: bad enough to refuse the step.
constexpr double kBehindCameraChi2 = 1e6;

/// What makes white noise of an error of the rotation.
Eigen::Matrix3d root_information(const RotationPrior& rotation) {
  return rotation.covariance.llt().matrixL().solve(Eigen::Matrix3d::Identity());
}

/// The error (rad) of a rotation against a known one.
Eigen::Vector3d error_rad(const Eigen::Matrix3d& R_camera_world, const RotationPrior& rotation) {
  return geometry::so3_log(R_camera_world * rotation.R_world_camera);
}

/// Sums over points of J^T J and -J^T r. With D = de/dp_camera and p = p_rotated, J = D [I, -[p]x], but for the factor
/// of Eq. (2) that is the same for all points. So J^T J has the blocks M = D^T D, B = -M [p]x and C = [p]x B.
struct PointSums {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero(), B = M, C = M;  ///< of M and C, the upper triangle
  Eigen::Vector3d q = Eigen::Vector3d::Zero(), p_q = q;       ///< -D^T r, and p x that

  /// D is multiplied by `scale_D`, r by `scale_r`.
  void add(const RgbdProjection& camera, const Eigen::Vector3d& p, const Eigen::Vector3d& p_camera, bool has_depth,
           const Eigen::Vector3d& r, double scale_D, double scale_r) {
    const double inverse_z = 1.0 / p_camera.z();
    const double u_x = scale_D * camera.fx * inverse_z, u_z = -u_x * p_camera.x() * inverse_z;  // rows of D
    const double v_y = scale_D * camera.fy * inverse_z, v_z = -v_y * p_camera.y() * inverse_z;
    const double d_z = has_depth ? -scale_D * camera.disparity_px_m * inverse_z * inverse_z : 0.0;
    const double xx = u_x * u_x, xz = u_x * u_z, yy = v_y * v_y, yz = v_y * v_z;  // entries of M
    const double zz = u_z * u_z + v_z * v_z + d_z * d_z;
    M(0, 0) += xx;
    M(0, 2) += xz;
    M(1, 1) += yy;
    M(1, 2) += yz;
    M(2, 2) += zz;
    Eigen::Matrix3d b;                                      // a row is p x the row of M
    b << p.y() * xz, p.z() * xx - p.x() * xz, -p.y() * xx,  //
        p.y() * yz - p.z() * yy, -p.x() * yz, p.x() * yy,   //
        p.y() * zz - p.z() * yz, p.z() * xz - p.x() * zz, p.x() * yz - p.y() * xz;
    B += b;
    C(0, 0) += p.y() * b(2, 0) - p.z() * b(1, 0);
    C(0, 1) += p.y() * b(2, 1) - p.z() * b(1, 1);
    C(0, 2) += p.y() * b(2, 2) - p.z() * b(1, 2);
    C(1, 1) += p.z() * b(0, 1) - p.x() * b(2, 1);
    C(1, 2) += p.z() * b(0, 2) - p.x() * b(2, 2);
    C(2, 2) += p.x() * b(1, 2) - p.y() * b(0, 2);
    const Eigen::Vector3d towards(-scale_r * u_x * r.x(), -scale_r * v_y * r.y(),
                                  -scale_r * (u_z * r.x() + v_z * r.y() + d_z * r.z()));
    q += towards;
    p_q += p.cross(towards);
  }

  /// `left_jacobian`: the factor of Eq. (2).
  NormalEquations equations(const Eigen::Matrix3d& left_jacobian) const {
    NormalEquations equations;
    equations.hessian.topLeftCorner<3, 3>() = M.selfadjointView<Eigen::Upper>();
    equations.hessian.topRightCorner<3, 3>() = B * left_jacobian;
    equations.hessian.bottomLeftCorner<3, 3>() = equations.hessian.topRightCorner<3, 3>().transpose();
    const Eigen::Matrix3d whole = C.selfadjointView<Eigen::Upper>();
    equations.hessian.bottomRightCorner<3, 3>() = left_jacobian.transpose() * whole * left_jacobian;
    equations.descent << q, left_jacobian.transpose() * p_q;
    return equations;
  }
};

}  // namespace

PoseCost::Scaling PoseCost::scaling_of(const PoseObservation& observation, double s) const {
  const double root_weight = std::sqrt(observation.weight);
  if (loss_) {
    constexpr double kTiny = 1e-9;  // rho(s) / s goes to 1
    const LossValue loss = (*loss_)(s);
    const double root_ratio = s < kTiny ? 1.0 : std::sqrt(loss.rho / s);
    return {root_weight * root_ratio, root_weight * loss.slope / root_ratio};
  }
  const double limit = chi2_limit(options_, observation);
  if (!robust_ || s <= limit) return {root_weight, root_weight};
  const double root_s = std::sqrt(s), delta = std::sqrt(limit);
  const double root_ratio = std::sqrt((2 * delta * root_s - limit) / s);
  return {root_weight * root_ratio, root_weight * (delta / root_s) / root_ratio};
}

template <class Visit>
double PoseCost::for_each(const Vector6d& x, const Visit& visit) const {
  const Eigen::Matrix3d R = geometry::so3_exp(x.tail<3>()) * T_camera_world_.linear();
  const Eigen::Vector3d t = T_camera_world_.translation() + x.head<3>();
  double squared = 0;
  for (const PoseObservation* observation : active_) {
    const Eigen::Vector3d p_rotated = R * observation->p_world, p_camera = p_rotated + t;
    if (p_camera.z() < kMinProjectionDepth_m) {
      squared += observation->weight * kBehindCameraChi2;
      continue;
    }
    const Eigen::Vector3d r = rgbd_residual(camera_, p_camera, observation->measured) / observation->sigma_px;
    const double chi2 = r.squaredNorm();
    const Scaling scaling = scaling_of(*observation, chi2);
    squared += scaling.residual * scaling.residual * chi2;
    visit(*observation, p_rotated, p_camera, r, scaling);
  }
  if (options_.position) squared += ((R * options_.position->p_world + t) / options_.position->sigma_m).squaredNorm();
  if (options_.rotation)
    squared += (root_information(*options_.rotation) * error_rad(R, *options_.rotation)).squaredNorm();
  return squared;
}

double PoseCost::squared(const Vector6d& x) const {
  return for_each(x, [](const auto&...) {});
}

NormalEquations PoseCost::linearize(const Vector6d& x) const {
  PointSums sums;
  const double squared = for_each(x, [&](const PoseObservation& observation, const Eigen::Vector3d& p_rotated,
                                         const Eigen::Vector3d& p_camera, const Eigen::Vector3d& r, Scaling scaling) {
    sums.add(camera_, p_rotated, p_camera, observation.measured.has_depth(), r, scaling.jacobian / observation.sigma_px,
             scaling.residual);
  });
  const Eigen::Matrix3d left_jacobian = geometry::so3_left_jacobian(x.tail<3>());
  NormalEquations equations = sums.equations(left_jacobian);
  equations.squared = squared;
  const Eigen::Matrix3d R = geometry::so3_exp(x.tail<3>()) * T_camera_world_.linear();
  if (options_.position) {  // seen from the right pose, it is at the origin of the camera
    const double sigma_m = options_.position->sigma_m;
    const Eigen::Vector3d rotated = R * options_.position->p_world;
    const Eigen::Matrix<double, 3, 6> J = point_jacobian(rotated, left_jacobian) / sigma_m;
    const Eigen::Vector3d r = (rotated + T_camera_world_.translation() + x.head<3>()) / sigma_m;
    equations.hessian += J.transpose() * J;
    equations.descent -= J.transpose() * r;
  }
  if (options_.rotation) {
    const Eigen::Matrix3d root = root_information(*options_.rotation);
    const Eigen::Vector3d off_rad = error_rad(R, *options_.rotation);
    const Eigen::Matrix3d J = root * geometry::so3_left_jacobian(off_rad).inverse() * left_jacobian;
    equations.hessian.bottomRightCorner<3, 3>() += J.transpose() * J;
    equations.descent.tail<3>() -= J.transpose() * (root * off_rad);
  }
  return equations;
}

namespace {

constexpr double kGradientTolerance = 1e-10, kStepTolerance = 1e-8, kCostTolerance = 1e-6;
constexpr double kMinCost = 2.2e-16;

/// Normal equations with columns of like length: those at the start have the norm 1 or less.
struct Scaled {
  NormalEquations at_x;
  Vector6d factors;

  Scaled(NormalEquations equations, const Vector6d& by) : at_x(std::move(equations)), factors(by) {
    at_x.hessian = by.asDiagonal() * at_x.hessian * by.asDiagonal();
    at_x.descent = by.asDiagonal() * at_x.descent;
  }
  bool solved() const {
    return !(at_x.descent.cwiseAbs().maxCoeff() >= kGradientTolerance) || !(0.5 * at_x.squared >= kMinCost);
  }
};

/// Marquardt's damping by the share `damping` of each diagonal entry.
Vector6d damped_step(const NormalEquations& equations, double damping) {
  constexpr double kMinDiagonal = 1e-6, kMaxDiagonal = 1e32;
  Matrix6d hessian = equations.hessian;
  hessian.diagonal() += damping * equations.hessian.diagonal().cwiseMax(kMinDiagonal).cwiseMin(kMaxDiagonal);
  return hessian.ldlt().solve(equations.descent);
}

}  // namespace

Vector6d solve(const PoseCost& cost, int max_iterations) {
  constexpr double kFirstDamping = 1e-4, kLeastDecrease = 1.0 / 3;
  Vector6d x = Vector6d::Zero();
  const NormalEquations first = cost.linearize(x);
  const Vector6d factors = (1.0 + first.hessian.diagonal().array().sqrt()).inverse();
  Scaled now(first, factors);
  double damping = kFirstDamping, increase = 2;
  for (int iteration = 1; iteration < max_iterations && !now.solved(); ++iteration) {
    const Vector6d step = damped_step(now.at_x, damping), dx = factors.cwiseProduct(step);
    if (dx.norm() < kStepTolerance * (x.norm() + kStepTolerance)) break;
    const double change = now.at_x.squared - cost.squared(x + dx);
    const double expected = step.dot(2 * now.at_x.descent - now.at_x.hessian * step);
    const double ratio = change / expected;
    if (ratio > 0) x += dx;
    if (std::abs(change) < kCostTolerance) break;
    if (ratio > 0) {
      now = Scaled(cost.linearize(x), factors);
      damping *= std::max(kLeastDecrease, 1 - std::pow(2 * ratio - 1, 3));
      increase = 2;
    } else {
      damping *= increase;
      increase *= 2;
    }
  }
  return x;
}

}  // namespace rtd::vision
