// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/optimize/bundle_adjustment.hpp"

#include <ceres/ceres.h>

#include <cmath>
#include <memory>

#include "common/geometry/se3.hpp"
#include "common/vision/pose_optimizer.hpp"
#include "services/slam/core/optimize/dense_bundle.hpp"
#include "services/slam/core/optimize/interrupt_callback.hpp"

namespace rtd::slam {
namespace {

using geometry::Vector6d;

template <int Dimension>
class ObservationCost final : public ceres::SizedCostFunction<Dimension, 6, 3> {
 public:
  ObservationCost(const vision::RgbdProjection& camera, const Eigen::Isometry3d& T_camera_world,
                  const BundleObservation& observation)
      : camera_(camera), T_camera_world_(T_camera_world), observation_(observation) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    evaluate_bundle_residual(camera_, T_camera_world_, observation_, parameters[0], parameters[1], residuals,
                             jacobians != nullptr ? jacobians[0] : nullptr,
                             jacobians != nullptr ? jacobians[1] : nullptr);
    return true;
  }

 private:
  const vision::RgbdProjection& camera_;
  const Eigen::Isometry3d& T_camera_world_;
  const BundleObservation& observation_;
};

double chi2_limit(const BundleOptions& options, const BundleObservation& observation) {
  return observation.measured.has_depth() ? options.max_chi2_rgbd : options.max_chi2_pixel;
}

/// One run of Ceres over the present inliers; poses are 6 local parameters around their present values.
class SparseBundle {
 public:
  SparseBundle(BundleProblem& problem, const BundleOptions& options) : problem_(problem), options_(options) {
    for (const BundleCamera& camera : problem.cameras) T_camera_world_.push_back(camera.T_world_camera.inverse());
    poses_.assign(problem.cameras.size(), Vector6d::Zero());
  }

  BundleSummary solve(int iterations, RobustLoss loss) {
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::TAKE_OWNERSHIP;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;  // blocks are added once each by construction
    ceres::Problem ceres_problem(problem_options);
    ceres::Solver::Options solver;
    solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    const std::vector<std::unique_ptr<ceres::LossFunction>> losses = add_observations(ceres_problem, loss);
    hold_gauge(ceres_problem, *solver.linear_solver_ordering);
    if (ceres_problem.NumResidualBlocks() == 0) return {};

    solver.linear_solver_type = ceres::SPARSE_SCHUR;
    solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // not CHOLMOD, parts of which are GPL
    solver.max_num_iterations = iterations;
    solver.num_threads = options_.threads;
    solver.logging_type = ceres::SILENT;
    solver.function_tolerance = 1e-7;  // bending a whole loop changes the cost little
    InterruptCallback interrupt(options_.interrupted);
    solver.callbacks.push_back(&interrupt);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &ceres_problem, &summary);
    if (summary.IsSolutionUsable()) apply();
    return {summary.initial_cost, summary.final_cost, static_cast<int>(summary.iterations.size()), 0};
  }

 private:
  std::vector<std::unique_ptr<ceres::LossFunction>> add_observations(ceres::Problem& ceres_problem, RobustLoss robust) {
    std::vector<std::unique_ptr<ceres::LossFunction>> losses;
    for (const BundleObservation& observation : problem_.observations) {
      if (!observation.inlier) continue;
      const Eigen::Isometry3d& T_camera_world = T_camera_world_[observation.camera];
      const vision::RgbdProjection& camera = problem_.projection_of(observation);
      ceres::CostFunction* cost = nullptr;
      if (observation.measured.has_depth()) {
        cost = new ObservationCost<3>(camera, T_camera_world, observation);  // owned by the ceres problem
      } else {
        cost = new ObservationCost<2>(camera, T_camera_world, observation);
      }
      ceres::LossFunction* loss = robust == RobustLoss::kHuber ? &huber(observation) : nullptr;
      if (observation.weight < 1) {
        // The weight multiplies the loss, so that the Huber threshold stays one of pixels.
        losses.push_back(std::make_unique<ceres::ScaledLoss>(loss, observation.weight, ceres::DO_NOT_TAKE_OWNERSHIP));
        loss = losses.back().get();
      }
      ceres_problem.AddResidualBlock(cost, loss, poses_[observation.camera].data(),
                                     problem_.points[observation.point].data());
    }
    return losses;
  }

  ceres::LossFunction& huber(const BundleObservation& observation) {
    return observation.measured.has_depth() ? huber_rgbd_ : huber_pixel_;
  }

  void hold_gauge(ceres::Problem& ceres_problem, ceres::ParameterBlockOrdering& ordering) {
    bool held = false;
    for (const BundleCamera& camera : problem_.cameras) held = held || camera.fixed;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      double* pose = poses_[i].data();
      if (!ceres_problem.HasParameterBlock(pose)) continue;
      ordering.AddElementToGroup(pose, 1);
      if (problem_.cameras[i].fixed || (!held && i == 0)) ceres_problem.SetParameterBlockConstant(pose);
    }
    for (Eigen::Vector3d& point : problem_.points) {
      if (ceres_problem.HasParameterBlock(point.data())) ordering.AddElementToGroup(point.data(), 0);
    }
  }

  void apply() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (poses_[i].isZero(0)) continue;
      Eigen::Isometry3d T_camera_world = T_camera_world_[i];
      T_camera_world.linear() = geometry::so3_exp(poses_[i].tail<3>()) * T_camera_world.linear();
      T_camera_world.translation() += poses_[i].head<3>();
      problem_.cameras[i].T_world_camera = geometry::normalized(T_camera_world).inverse();
    }
  }

  BundleProblem& problem_;
  const BundleOptions& options_;
  ceres::HuberLoss huber_pixel_{std::sqrt(options_.max_chi2_pixel)}, huber_rgbd_{std::sqrt(options_.max_chi2_rgbd)};
  std::vector<Eigen::Isometry3d> T_camera_world_;
  std::vector<Vector6d> poses_;  ///< [rho; phi]
};

int classify(BundleProblem& problem, const BundleOptions& options) {
  int outliers = 0;
  for (BundleObservation& observation : problem.observations) {
    const Eigen::Vector3d p_camera =
        problem.cameras[observation.camera].T_world_camera.inverse() * problem.points[observation.point];
    observation.inlier = p_camera.z() >= vision::kMinProjectionDepth_m &&
                         (vision::rgbd_residual(problem.projection_of(observation), p_camera, observation.measured) /
                          observation.sigma_px)
                                 .squaredNorm() <= chi2_limit(options, observation);
    if (!observation.inlier) ++outliers;
  }
  return outliers;
}

BundleSummary solve(BundleProblem& problem, const BundleOptions& options, int iterations, RobustLoss loss) {
  if (options.solver == BundleSolver::kSparse) return SparseBundle(problem, options).solve(iterations, loss);
  return DenseBundle(problem, options).solve(iterations, loss);
}

}  // namespace

void evaluate_bundle_residual(const vision::RgbdProjection& camera, const Eigen::Isometry3d& T_camera_world,
                              const BundleObservation& observation, const double* pose, const double* point,
                              double* residuals, double* jacobian_pose, double* jacobian_point) {
  const Eigen::Map<const Vector6d> x(pose);
  const Eigen::Map<const Eigen::Vector3d> p_world(point);
  const int dimension = observation.measured.dimension();
  const Eigen::Vector3d phi = x.tail<3>();
  const Eigen::Matrix3d R = geometry::so3_exp(phi) * T_camera_world.linear();
  const Eigen::Vector3d p_rotated = R * p_world, p_camera = p_rotated + T_camera_world.translation() + x.head<3>();
  using RowMajor36 = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, 3, 6>;
  using RowMajor33 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, 3, 3>;
  if (p_camera.z() < vision::kMinProjectionDepth_m) {
    Eigen::Map<Eigen::VectorXd>(residuals, dimension).setConstant(kBehindCameraResidual);
    if (jacobian_pose != nullptr) Eigen::Map<RowMajor36>(jacobian_pose, dimension, 6).setZero();
    if (jacobian_point != nullptr) Eigen::Map<RowMajor33>(jacobian_point, dimension, 3).setZero();
    return;
  }
  const double whitening = 1.0 / observation.sigma_px;
  const Eigen::Vector3d residual = whitening * vision::rgbd_residual(camera, p_camera, observation.measured);
  Eigen::Map<Eigen::VectorXd>(residuals, dimension) = residual.head(dimension);
  if (jacobian_pose != nullptr) {
    const Eigen::Matrix<double, 3, 6> J =
        vision::pose_jacobian(camera, p_rotated, p_camera, geometry::so3_left_jacobian(phi), observation.measured);
    Eigen::Map<RowMajor36>(jacobian_pose, dimension, 6) = whitening * J.topRows(dimension);
  }
  if (jacobian_point != nullptr) {
    const Eigen::Matrix3d J = vision::rgbd_jacobian(camera, p_camera, observation.measured) * R;
    Eigen::Map<RowMajor33>(jacobian_point, dimension, 3) = whitening * J.topRows(dimension);
  }
}

BundleSummary adjust_bundle(BundleProblem& problem, const BundleOptions& options) {
  BundleSummary summary = solve(problem, options, options.iterations_robust, RobustLoss::kHuber);
  summary.outliers = classify(problem, options);
  if (options.iterations == 0 || (options.interrupted && options.interrupted())) return summary;
  const BundleSummary precise = solve(problem, options, options.iterations, RobustLoss::kNone);
  summary.final_cost = precise.final_cost;
  summary.iterations += precise.iterations;
  summary.outliers = classify(problem, options);
  return summary;
}

}  // namespace rtd::slam
