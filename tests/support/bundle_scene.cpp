// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/bundle_scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "common/geometry/se3.hpp"
#include "services/slam/core/map/frame.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::test_support {
namespace {

class Generator {
 public:
  explicit Generator(const BundleSceneOptions& options) : options_(options), random_(options.seed) {}

  BundleScene make() {
    BundleScene scene;
    slam::BundleProblem& truth = scene.truth;
    truth.camera = {FeatureWorld::kFx, FeatureWorld::kFy, FeatureWorld::kCx, FeatureWorld::kCy, 40.0};
    const std::size_t cameras = options_.keyframes + options_.fixed_keyframes;
    for (std::size_t i = 0; i < cameras; ++i) {
      const double along = static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(cameras - 1, 1));
      truth.cameras.push_back({pose_along(along), i >= options_.keyframes});
    }
    while (truth.points.size() < options_.landmarks) add_point(truth);
    scene.problem = truth;
    const bool hold_first = options_.fixed_keyframes == 0;
    for (std::size_t i = hold_first ? 1 : 0; i < options_.keyframes; ++i) {
      slam::BundleCamera& camera = scene.problem.cameras[i];
      camera.T_world_camera = camera.T_world_camera * geometry::se3_exp(options_.pose_error_m * normal6());
    }
    for (Eigen::Vector3d& point : scene.problem.points) point += options_.point_error_m * normal6().head<3>();
    return scene;
  }

 private:
  static Eigen::Isometry3d pose_along(double along) {
    geometry::Vector6d twist;
    twist << along, 0.1 * std::sin(6 * along), 0.2 * std::sin(4 * along), 0.05 * std::sin(5 * along), -0.2 * along,
        0.05 * std::cos(5 * along);
    return geometry::se3_exp(twist);
  }

  geometry::Vector6d normal6() {
    geometry::Vector6d values;
    for (double& value : values) value = normal_(random_);
    return values;
  }

  /// A point with at least two views.
  void add_point(slam::BundleProblem& truth) {
    const double z = 1 + 3 * unit_(random_);
    const double y = z * (unit_(random_) - 0.5), x = 0.5 + z * (1.6 * unit_(random_) - 0.8);
    const Eigen::Vector3d p_world(x, y, z);
    const double max_distance_m = p_world.norm() * std::pow(slam::kScaleFactor, 5 * unit_(random_));
    const auto index = static_cast<std::uint32_t>(truth.points.size());
    const std::size_t before = truth.observations.size();
    for (std::uint32_t camera = 0; camera < truth.cameras.size(); ++camera) {
      if (const auto seen = observe(truth, camera, p_world, max_distance_m)) {
        truth.observations.push_back(*seen);
        truth.observations.back().point = index;
      }
    }
    if (truth.observations.size() - before >= 2) {
      truth.points.push_back(p_world);
    } else {
      truth.observations.resize(before);
    }
  }

  std::optional<slam::BundleObservation> observe(const slam::BundleProblem& truth, std::uint32_t camera,
                                                 const Eigen::Vector3d& p_world, double max_distance_m) {
    const Eigen::Vector3d p = truth.cameras[camera].T_world_camera.inverse() * p_world;
    if (p.z() < 0.3 || unit_(random_) > options_.detection_rate) return std::nullopt;
    slam::BundleObservation seen;
    seen.camera = camera;
    seen.sigma_px = slam::sigma_px(slam::predict_octave(max_distance_m, p.norm()));
    const bool outlier = unit_(random_) < options_.outlier_rate;
    const double spread_px = outlier ? 30.0 : options_.noise_px * seen.sigma_px;
    seen.measured.pixel = {truth.camera.fx * p.x() / p.z() + truth.camera.cx + spread_px * normal_(random_),
                           truth.camera.fy * p.y() / p.z() + truth.camera.cy + spread_px * normal_(random_)};
    if (seen.measured.pixel.x() < 0 || seen.measured.pixel.x() >= FeatureWorld::kWidth || seen.measured.pixel.y() < 0 ||
        seen.measured.pixel.y() >= FeatureWorld::kHeight) {
      return std::nullopt;
    }
    if (unit_(random_) < options_.depth_rate) {
      const double disparity_px = truth.camera.disparity_px_m / p.z() + options_.noise_px * normal_(random_);
      seen.measured.depth_m = truth.camera.disparity_px_m / std::max(disparity_px, 1.0);
    }
    seen.weight = unit_(random_) < 0.2 ? 0.6 : 1.0;
    return seen;
  }

  BundleSceneOptions options_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> unit_{0, 1};
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace

BundleScene make_bundle_scene(const BundleSceneOptions& options) {
  return Generator(options).make();
}

double worst_camera_error_m(const BundleScene& scene) {
  double worst_m = 0;
  for (std::size_t i = 0; i < scene.truth.cameras.size(); ++i) {
    const Eigen::Isometry3d T_true_found =
        scene.truth.cameras[i].T_world_camera.inverse() * scene.problem.cameras[i].T_world_camera;
    worst_m = std::max(worst_m, T_true_found.translation().norm());
  }
  return worst_m;
}

}  // namespace rtd::test_support
