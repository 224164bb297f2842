// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/vision/reprojection.hpp"

namespace rtd::slam {

struct BundleCamera {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  bool fixed = false;                                               ///< holds the gauge
  std::optional<vision::RgbdProjection> intrinsics = std::nullopt;  ///< where they are not BundleProblem::camera
};

struct BundleObservation {
  std::uint32_t camera = 0, point = 0;  ///< indices into the problem
  vision::RgbdMeasurement measured;
  double sigma_px = 1.0;
  double weight = 1.0;  ///< [0, 1], static probability
  bool inlier = true;   ///< out: chi2 test after the optimisation
};

/// Cameras, points and measurements; adjust_bundle() moves them in place.
struct BundleProblem {
  vision::RgbdProjection camera;
  std::vector<BundleCamera> cameras;
  std::vector<Eigen::Vector3d> points;  ///< p_world, m
  std::vector<BundleObservation> observations;

  const vision::RgbdProjection& projection_of(const BundleObservation& observation) const {
    const auto& own = cameras[observation.camera].intrinsics;
    return own ? *own : camera;
  }
};

enum class BundleSolver : std::uint8_t {
  kDense,   ///< all cameras see each other: local bundle adjustment (dense_bundle.hpp)
  kSparse,  ///< Ceres; long ways: global bundle adjustment
};

struct BundleOptions {
  int iterations_robust = 5;  ///< first stage, Huber loss
  int iterations = 5;         ///< second stage, inliers of the first only, no loss
  double max_chi2_pixel = 5.991, max_chi2_rgbd = 7.815;
  BundleSolver solver = BundleSolver::kDense;
  int threads = 1;  ///< of kSparse; the result does not depend on it beyond rounding
  /// True ends early with what is reached. kDense polls every 0.1 ms, kSparse between iterations.
  std::function<bool()> interrupted;
};

struct BundleSummary {
  double initial_cost = 0, final_cost = 0;
  int iterations = 0;
  int outliers = 0;
};

enum class RobustLoss : std::uint8_t { kNone, kHuber };

/// Residuals of a point behind the camera: a constant that makes the step bad.
inline constexpr double kBehindCameraResidual = 1e3;

/// Bundle adjustment (Schur complement), docs/theory/mapping.md Eq. (1)-(3). Deterministic with one thread.
/// Without a fixed camera the first one is held.
BundleSummary adjust_bundle(BundleProblem& problem, const BundleOptions& options);

/// The cost of one observation with its analytic derivatives; public for its test. `pose` = [rho; phi] around
/// `T_camera_world`, `point` = p_world. Writes 3 (with depth) or 2 residuals, Jacobians row-major, each may be null.
void evaluate_bundle_residual(const vision::RgbdProjection& camera, const Eigen::Isometry3d& T_camera_world,
                              const BundleObservation& observation, const double* pose, const double* point,
                              double* residuals, double* jacobian_pose, double* jacobian_point);

}  // namespace rtd::slam
