// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/pose_optimizer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "common/vision/general_loss.hpp"
#include "common/vision/pose_solver.hpp"

namespace rtd::vision {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;
using Matrix36d = Eigen::Matrix<double, 3, 6>;

/// chi2 of an observation, infinite behind the camera.
double chi2(const RgbdProjection& camera, const Eigen::Isometry3d& T_camera_world, const PoseObservation& observation) {
  const Eigen::Vector3d p_camera = T_camera_world * observation.p_world;
  if (p_camera.z() < kMinProjectionDepth_m) return std::numeric_limits<double>::infinity();
  return (rgbd_residual(camera, p_camera, observation.measured) / observation.sigma_px).squaredNorm();
}

/// The loss that suits the residuals of all observations, outliers too, at this pose.
GeneralLoss fit_loss(const RgbdProjection& camera, const std::vector<PoseObservation>& observations,
                     const Eigen::Isometry3d& T_camera_world) {
  constexpr double kMaxChi2 = 600;  // larger ones carry no information about the shape
  std::vector<SquaredResidual> residuals;
  residuals.reserve(observations.size());
  for (const PoseObservation& observation : observations) {
    const double value = chi2(camera, T_camera_world, observation);
    if (value < kMaxChi2) residuals.push_back({value, observation.measured.dimension()});
  }
  return fit_general_loss(residuals, {});
}

void classify(const RgbdProjection& camera, const std::vector<PoseObservation>& observations,
              const Eigen::Isometry3d& T_camera_world, const PoseOptimizerOptions& options,
              PoseOptimizerResult& result) {
  result.inliers = 0;
  double sum_chi2 = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const double value = chi2(camera, T_camera_world, observations[i]);
    result.inlier[i] = value <= chi2_limit(options, observations[i]) ? 1 : 0;
    if (result.inlier[i] == 0) continue;
    ++result.inliers;
    sum_chi2 += value;
  }
  result.rmse_px = result.inliers > 0 ? std::sqrt(sum_chi2 / result.inliers) : 0.0;
}

/// Information of the inliers about the pose in [rho; phi] at T_camera_world.
struct Information {
  Matrix6d pixels = Matrix6d::Zero(), depths = Matrix6d::Zero();  ///< Gauss-Newton Hessians, weights not squared
  Matrix6d pixels_squared = Matrix6d::Zero(), depths_squared = Matrix6d::Zero();  ///< weights squared
  Matrix6d known = Matrix6d::Zero();  ///< of a RotationPrior and a PositionPrior
  double pixel_chi2 = 0, depth_chi2 = 0, pixel_residuals = 0, depth_residuals = 0;
};

Information gather(const RgbdProjection& camera, const std::vector<PoseObservation>& observations,
                   const std::vector<char>& inlier, const Eigen::Isometry3d& T_camera_world) {
  Information sum;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (inlier[i] == 0) continue;
    const PoseObservation& observation = observations[i];
    const Eigen::Vector3d p_rotated = T_camera_world.linear() * observation.p_world;
    const Eigen::Vector3d p_camera = p_rotated + T_camera_world.translation();
    const Matrix36d J = pose_jacobian(camera, p_rotated, p_camera, Eigen::Matrix3d::Identity(), observation.measured) /
                        observation.sigma_px;
    const Eigen::Vector3d r = rgbd_residual(camera, p_camera, observation.measured) / observation.sigma_px;
    const Matrix6d pixels = J.topRows<2>().transpose() * J.topRows<2>();
    const double w = observation.weight;
    sum.pixels += w * pixels;
    sum.pixels_squared += w * w * pixels;
    sum.pixel_chi2 += w * r.head<2>().squaredNorm();
    sum.pixel_residuals += 2 * w;
    if (!observation.measured.has_depth()) continue;
    const Matrix6d depths = J.row(2).transpose() * J.row(2);
    sum.depths += w * depths;
    sum.depths_squared += w * w * depths;
    sum.depth_chi2 += w * r.z() * r.z();
    sum.depth_residuals += w;
  }
  return sum;
}

/// Whether the camera is about where it is expected. Elsewhere it has been carried there, and nothing is known.
bool expected(const PositionPrior& position, const Eigen::Isometry3d& T_camera_world) {
  constexpr double kMostSigmas = 4;
  return (T_camera_world * position.p_world).norm() <= kMostSigmas * position.sigma_m;
}

/// Adds what a known position says.
void add_position(const PositionPrior& position, const Eigen::Isometry3d& T_camera_world, Information& sum) {
  const Matrix36d J = point_jacobian(T_camera_world.linear() * position.p_world, Eigen::Matrix3d::Identity());
  sum.known += J.transpose() * J / (position.sigma_m * position.sigma_m);
}

/// Adds what a known rotation says, whose covariance is right.
void add_rotation(const RotationPrior& rotation, Information& sum) {
  sum.known.bottomRightCorner<3, 3>() += rotation.covariance.inverse();
}

/// Variance of whitened residuals, as found. Few of them are uncertain: the assumed 1 counts as this many more.
double found_variance(double chi2, double residuals) {
  constexpr double kAssumed = 12.0;
  return (chi2 + kAssumed) / (residuals + kAssumed);
}

/// The variance of a Gaussian of which the residuals beyond `limit` (squared norm of two) were left out when `variance`
/// was formed: fixed point of E[s | s <= limit] = 2 whole - limit / (exp(limit / (2 whole)) - 1).
double untruncated(double variance, double limit) {
  constexpr double kMax = 4.0;
  double whole = variance;
  for (int i = 0; i < 10; ++i) whole = std::min(kMax, variance + 0.5 * limit / std::expm1(limit / (2 * whole)));
  return whole;
}

/// Covariance of the least-squares pose whatever the noise really is: H^-1 M H^-1 with the variances found, turned from
/// [rho; phi] in the camera frame to (x y z rx ry rz) in the world frame, docs/theory/tracking.md Eq. (4). False when
/// some direction of the pose is not determined.
bool world_covariance(const Information& information, const Eigen::Isometry3d& T_camera_world, Matrix6d& covariance) {
  // Metres and radians are of like size here; a direction known ten million times worse than the best is not known.
  constexpr double kMinConditionInverse = 1e-14;
  constexpr double kPixelLimit = 7.0;  // between the limits of inliers with and without depth
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information.pixels + information.depths + information.known);
  const Vector6d& values = eigen.eigenvalues();
  if (!(values.maxCoeff() > 0) || values.minCoeff() < kMinConditionInverse * values.maxCoeff()) return false;
  const Matrix6d inverse = eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::Matrix3d R_world_camera = T_camera_world.linear().transpose();
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = -R_world_camera;
  A.topRightCorner<3, 3>() = -R_world_camera * geometry::skew(T_camera_world.translation());
  A.bottomRightCorner<3, 3>() = -R_world_camera;
  const Matrix6d M = untruncated(found_variance(information.pixel_chi2, information.pixel_residuals), kPixelLimit) *
                         information.pixels_squared +
                     found_variance(information.depth_chi2, information.depth_residuals) * information.depths_squared +
                     information.known;
  covariance = A * inverse * M * inverse * A.transpose();
  return true;
}

}  // namespace

Matrix36d point_jacobian(const Eigen::Vector3d& p_rotated, const Eigen::Matrix3d& left_jacobian) {
  Matrix36d J;
  J << Eigen::Matrix3d::Identity(), -geometry::skew(p_rotated) * left_jacobian;
  return J;
}

Matrix36d pose_jacobian(const RgbdProjection& camera, const Eigen::Vector3d& p_rotated, const Eigen::Vector3d& p_camera,
                        const Eigen::Matrix3d& left_jacobian, const RgbdMeasurement& measured) {
  const Eigen::Matrix3d d_residual = rgbd_jacobian(camera, p_camera, measured);
  Matrix36d J;
  J.leftCols<3>() = d_residual;
  J.rightCols<3>() = -d_residual * geometry::skew(p_rotated) * left_jacobian;
  return J;
}

PoseOptimizerResult optimize_pose(const RgbdProjection& camera, const std::vector<PoseObservation>& observations,
                                  const Eigen::Isometry3d& T_world_camera_initial, const PoseOptimizerOptions& given) {
  PoseOptimizerOptions options = given;
  PoseOptimizerResult result;
  result.T_world_camera = T_world_camera_initial;
  result.inlier.assign(observations.size(), 1);
  result.inliers = static_cast<int>(observations.size());
  Eigen::Isometry3d T_camera_world = T_world_camera_initial.inverse();

  for (int round = 0; round < options.rounds; ++round) {
    std::optional<GeneralLoss> loss;
    // The start may be far off: its residuals are not those of the noise, and Huber's loss pulls from afar.
    if (options.kernel == RobustKernel::kAdaptive && round > 0) loss = fit_loss(camera, observations, T_camera_world);
    PoseCost cost(camera, T_camera_world, options, round < options.robust_rounds, loss);
    cost.reserve(observations.size());
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (result.inlier[i] != 0) cost.add(observations[i]);
    }
    if (static_cast<int>(cost.size()) < options.min_inliers) break;
    const Vector6d x = solve(cost, options.max_iterations);
    if (!x.allFinite()) break;
    T_camera_world.linear() = geometry::so3_exp(x.tail<3>()) * T_camera_world.linear();
    T_camera_world.translation() += x.head<3>();
    classify(camera, observations, T_camera_world, options, result);
    if (options.position && !expected(*options.position, T_camera_world)) options.position.reset();
  }

  T_camera_world = geometry::normalized(T_camera_world);
  result.T_world_camera = T_camera_world.inverse();
  Information information = gather(camera, observations, result.inlier, T_camera_world);
  const bool seen = world_covariance(information, T_camera_world, result.image_covariance);
  result.covariance = result.image_covariance;
  bool determined = seen;
  if (options.rotation || options.position) {
    if (options.rotation) add_rotation(*options.rotation, information);
    if (options.position) add_position(*options.position, T_camera_world, information);
    determined = world_covariance(information, T_camera_world, result.covariance);
    if (!seen) result.image_covariance = result.covariance;
  }
  result.success = result.inliers >= options.min_inliers && determined;
  return result;
}

}  // namespace rtd::vision
