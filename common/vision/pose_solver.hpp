// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/vision/general_loss.hpp"
#include "common/vision/pose_optimizer.hpp"

namespace rtd::vision {

inline double chi2_limit(const PoseOptimizerOptions& options, const PoseObservation& observation) {
  return observation.measured.has_depth() ? options.max_chi2_rgbd : options.max_chi2_pixel;
}

/// What a Gauss-Newton step needs to know of a sum of squared residuals |r|^2.
struct NormalEquations {
  geometry::Matrix6d hessian = geometry::Matrix6d::Zero();  ///< J^T J
  geometry::Vector6d descent = geometry::Vector6d::Zero();  ///< -J^T r
  double squared = 0;                                       ///< |r|^2
};

/// The robust cost of one camera's pose, docs/theory/tracking.md Eq. (1)-(3), over x = [rho; phi] around a pose:
/// p_camera = exp(phi) R p_world + t + rho. Refers to the observations and options, which must outlive it.
class PoseCost {
 public:
  /// `robust`: Huber's loss, else none; `loss` instead of both.
  PoseCost(const RgbdProjection& camera, const Eigen::Isometry3d& T_camera_world, const PoseOptimizerOptions& options,
           bool robust, const std::optional<GeneralLoss>& loss)
      : camera_(camera), T_camera_world_(T_camera_world), options_(options), robust_(robust), loss_(loss) {}

  void reserve(std::size_t observations) { active_.reserve(observations); }
  void add(const PoseObservation& observation) { active_.push_back(&observation); }
  std::size_t size() const { return active_.size(); }

  double squared(const geometry::Vector6d& x) const;
  NormalEquations linearize(const geometry::Vector6d& x) const;

 private:
  /// Factors that make |r|^2 the weighted loss w*rho(s) and J^T r its exact gradient, Eq. (3): r = sqrt(w rho/s) e, J =
  /// sqrt(w) rho' / sqrt(rho/s) de/dx.
  struct Scaling {
    double residual, jacobian;
  };
  Scaling scaling_of(const PoseObservation& observation, double s) const;

  /// Calls visit(observation, p_rotated, p_camera, residual, scaling) for each observation before the camera and
  /// returns the sum of the squared residuals.
  template <class Visit>
  double for_each(const geometry::Vector6d& x, const Visit& visit) const;

  RgbdProjection camera_;
  Eigen::Isometry3d T_camera_world_;
  const PoseOptimizerOptions& options_;
  bool robust_;
  std::optional<GeneralLoss> loss_;
  std::vector<const PoseObservation*> active_;
};

/// The x of the least cost, from 0 on: Levenberg-Marquardt with the steps of Ceres' TinySolver, whose normal equations
/// are summed up without the Jacobians of all observations.
geometry::Vector6d solve(const PoseCost& cost, int max_iterations);

}  // namespace rtd::vision
