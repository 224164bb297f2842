// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "common/geometry/se3.hpp"
#include "services/slam/core/optimize/bundle_adjustment.hpp"

namespace rtd::slam {

/// Levenberg-Marquardt for a bundle of few cameras that see each other, docs/theory/mapping.md Eq. (1)-(3) and (7)-(9):
/// the sums of Eq. (3) are formed landmark by landmark, without a Jacobian in between, and the flag is polled every few
/// landmarks. The same minimum as Ceres' Schur solvers find, five times sooner. Deterministic, one thread.
class DenseBundle {
 public:
  /// Over the inliers of `problem`, which must outlive this; without a fixed camera the first one is held.
  DenseBundle(BundleProblem& problem, const BundleOptions& options);

  /// Moves cameras and points of the problem. Interrupted: to the best that is reached.
  BundleSummary solve(int max_iterations, RobustLoss loss);

 private:
  using Matrix63d = Eigen::Matrix<double, 6, 3>;
  /// Where the camera of an observation is, and where its landmark's point.
  struct State {
    std::vector<Eigen::Isometry3d> T_camera_world;
    std::vector<Eigen::Vector3d> points;
    double cost = 0;
  };
  struct Step {
    std::vector<geometry::Vector6d> cameras;  ///< [rho; phi] of the free ones
    std::vector<Eigen::Vector3d> points;
    double expected_decrease = 0;  ///< of the cost, by the linearised model
  };

  bool linearize(State& state, RobustLoss loss);
  void add(const BundleObservation& observation, std::size_t place, const State& state, RobustLoss loss, double& cost);
  bool eliminate_points(double damping);
  bool solve_step(double damping, Step& step);
  State moved(const State& state, const Step& step) const;
  bool interrupted() const { return options_.interrupted && options_.interrupted(); }

  BundleProblem& problem_;
  const BundleOptions& options_;
  static constexpr int kFixed = -1;
  std::vector<int> free_index_;         ///< per camera, kFixed where it is held
  std::vector<std::uint32_t> ordered_;  ///< observations (inliers), by point
  std::vector<std::uint32_t> first_;    ///< per point, its first place in ordered_; one more at the end

  // H = [B E; E' C] and the gradient [v; w], where B (its lower triangle) and C have one block for each camera and
  // point.
  std::vector<geometry::Matrix6d> B_;
  std::vector<geometry::Vector6d> v_;
  std::vector<Eigen::Matrix3d> C_, C_inverse_;
  std::vector<Eigen::Vector3d> w_;
  std::vector<Matrix63d> E_;  ///< by place in ordered_
  Eigen::MatrixXd S_;         ///< B - E C^-1 E', lower triangle
  Eigen::VectorXd s_;         ///< v - E C^-1 w
};

}  // namespace rtd::slam
