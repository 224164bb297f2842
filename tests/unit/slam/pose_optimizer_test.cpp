// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "common/vision/general_loss.hpp"
#include "common/vision/pose_optimizer.hpp"
#include "common/vision/pose_solver.hpp"

namespace rtd::vision {
namespace {

const RgbdProjection kCamera{520.0, 521.0, 319.5, 239.5, 40.0};

struct Scene {
  Eigen::Isometry3d T_world_camera;
  std::vector<PoseObservation> observations;
};

Eigen::Isometry3d make_pose(const geometry::Vector6d& twist) {
  return geometry::se3_exp(twist);
}

/// Points in front of a known camera, measured with Gaussian noise; every second one with depth.
Scene make_scene(std::size_t points, double noise_px, std::uint64_t seed = 7) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(20, 620), v(20, 460), depth(0.8, 5.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  Scene scene{make_pose((geometry::Vector6d() << 0.4, -0.2, 1.0, 0.3, -0.5, 0.2).finished()), {}};
  for (std::size_t i = 0; i < points; ++i) {
    const double z = depth(random);
    const Eigen::Vector2d pixel{u(random), v(random)};
    const Eigen::Vector3d p_camera((pixel.x() - kCamera.cx) / kCamera.fx * z, (pixel.y() - kCamera.cy) / kCamera.fy * z,
                                   z);
    PoseObservation observation;
    observation.p_world = scene.T_world_camera * p_camera;
    observation.measured.pixel = pixel + noise_px * Eigen::Vector2d{noise(random), noise(random)};
    const double disparity = kCamera.disparity_px_m / z + noise_px * noise(random);
    observation.measured.depth_m = i % 2 == 0 ? kCamera.disparity_px_m / disparity : 0.0;
    scene.observations.push_back(observation);
  }
  return scene;
}

Eigen::Isometry3d disturbed(const Eigen::Isometry3d& T_world_camera) {
  return T_world_camera * make_pose((geometry::Vector6d() << 0.05, -0.04, 0.06, 0.03, -0.04, 0.05).finished());
}

TEST(PoseOptimizer, a_known_position_decides_what_points_on_one_side_leave_open) {
  Scene scene = make_scene(400, 1.0);
  std::erase_if(scene.observations,
                [](const PoseObservation& o) { return o.measured.pixel.x() > 120 || o.measured.pixel.y() > 140; });
  for (PoseObservation& observation : scene.observations) observation.measured.depth_m = 0;
  PoseOptimizerOptions options;
  const double alone_m =
      (optimize_pose(kCamera, scene.observations, scene.T_world_camera).T_world_camera.translation() -
       scene.T_world_camera.translation())
          .norm();
  options.position = PositionPrior{scene.T_world_camera.translation(), 0.003};
  const auto held = optimize_pose(kCamera, scene.observations, scene.T_world_camera, options);
  ASSERT_TRUE(held.success);
  const double held_m = (held.T_world_camera.translation() - scene.T_world_camera.translation()).norm();
  EXPECT_GT(alone_m, 0.005);
  EXPECT_LT(held_m, 0.5 * alone_m);
  options.position->p_world += Eigen::Vector3d(0.5, 0, 0);
  options.position->sigma_m = 0.02;
  const Scene whole = make_scene(400, 1.0);
  const auto seen = optimize_pose(kCamera, whole.observations, disturbed(whole.T_world_camera), options);
  EXPECT_LT((seen.T_world_camera.translation() - whole.T_world_camera.translation()).norm(), 0.003)
      << "an image full of points outweighs a wrong expectation";
}

TEST(PoseOptimizer, recovers_exact_pose_from_perfect_points) {
  const Scene scene = make_scene(100, 0.0);
  const auto result = optimize_pose(kCamera, scene.observations, disturbed(scene.T_world_camera));
  ASSERT_TRUE(result.success);
  EXPECT_EQ(result.inliers, 100);
  EXPECT_LT((result.T_world_camera.inverse() * scene.T_world_camera).translation().norm(), 1e-6);         // m
  EXPECT_LT(geometry::rotation_angle_rad(result.T_world_camera.inverse() * scene.T_world_camera), 1e-6);  // rad
}

/// 200 points with depth at every second one, of which the first ones are off to one side.
Scene with_gross_outliers(int outliers, std::uint64_t seed) {
  Scene scene = make_scene(200, 0.3, seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> shift(15, 80);
  for (int i = 0; i < outliers; ++i)
    scene.observations[static_cast<std::size_t>(i)].measured.pixel.x() += shift(random);
  return scene;
}

TEST(PoseOptimizer, ignores_gross_outliers) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Scene scene = with_gross_outliers(60, seed);
    const auto result = optimize_pose(kCamera, scene.observations, disturbed(scene.T_world_camera));
    ASSERT_TRUE(result.success) << seed;
    EXPECT_LT((result.T_world_camera.inverse() * scene.T_world_camera).translation().norm(), 2e-3) << seed;  // m
    EXPECT_TRUE(std::none_of(result.inlier.begin(), result.inlier.begin() + 60, [](bool inlier) { return inlier; }));
    EXPECT_GE(result.inliers, 137) << seed;
  }
}

TEST(PoseOptimizer, says_so_when_there_are_too_many_outliers) {
  int successes = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Scene scene = with_gross_outliers(80, seed);
    const auto result = optimize_pose(kCamera, scene.observations, disturbed(scene.T_world_camera));
    if (!result.success) continue;
    ++successes;
    EXPECT_LT((result.T_world_camera.inverse() * scene.T_world_camera).translation().norm(), 2e-3) << seed;  // m
  }
  EXPECT_GE(successes, 8) << "11 of 30 when this was written";
}

TEST(PoseOptimizer, adaptive_kernel_withstands_heavy_tails_better_than_huber) {
  double error_huber_m = 0, error_adaptive_m = 0;
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    Scene scene = make_scene(150, 0.5, 300 + trial);
    std::mt19937_64 random(trial);
    std::uniform_real_distribution<double> shift(0.5, 4);
    for (std::size_t i = 0; i < 45; ++i) scene.observations[i].measured.pixel.x() += shift(random);  // 30 %, one-sided
    PoseOptimizerOptions adaptive;
    adaptive.kernel = RobustKernel::kAdaptive;
    const auto start = disturbed(scene.T_world_camera);
    const auto error_m = [&](const PoseOptimizerOptions& options) {
      const auto result = optimize_pose(kCamera, scene.observations, start, options);
      EXPECT_TRUE(result.success);
      return (result.T_world_camera.translation() - scene.T_world_camera.translation()).norm();
    };
    error_huber_m += error_m({});
    error_adaptive_m += error_m(adaptive);
  }
  EXPECT_LT(error_adaptive_m, 0.9 * error_huber_m);
}

TEST(PoseOptimizer, zero_weight_takes_an_observation_out) {
  Scene scene = make_scene(60, 0.0);
  for (std::size_t i = 0; i < 20; ++i) {
    scene.observations[i].measured.pixel.y() += 1.5;  // small enough to pass for inliers
    scene.observations[i].weight = 0.0;
  }
  const auto result = optimize_pose(kCamera, scene.observations, disturbed(scene.T_world_camera));
  ASSERT_TRUE(result.success);
  EXPECT_LT((result.T_world_camera.inverse() * scene.T_world_camera).translation().norm(), 1e-6);
}

TEST(PoseOptimizer, covariance_predicts_the_spread_of_the_pose) {
  geometry::Matrix6d sum = geometry::Matrix6d::Zero(), predicted = geometry::Matrix6d::Zero();
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Scene scene = make_scene(80, 1.0, 100 + trial);
    const auto result = optimize_pose(kCamera, scene.observations, scene.T_world_camera);
    ASSERT_TRUE(result.success);
    geometry::Vector6d error;
    error.head<3>() = result.T_world_camera.translation() - scene.T_world_camera.translation();
    error.tail<3>() = geometry::so3_log(result.T_world_camera.linear() * scene.T_world_camera.linear().transpose());
    sum += error * error.transpose() / kTrials;
    predicted += result.covariance / kTrials;
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(sum(i, i) / predicted(i, i)), 1.0, 0.2) << "axis " << i;
  // The off-diagonal terms carry the frame: a covariance left in the camera frame fails here.
  EXPECT_NEAR(sum(0, 4) / std::sqrt(sum(0, 0) * sum(4, 4)),
              predicted(0, 4) / std::sqrt(predicted(0, 0) * predicted(4, 4)), 0.15);
}

TEST(PoseOptimizer, fails_without_enough_points) {
  const Scene scene = make_scene(5, 0.0);
  EXPECT_FALSE(optimize_pose(kCamera, scene.observations, scene.T_world_camera).success);
  EXPECT_FALSE(optimize_pose(kCamera, {}, scene.T_world_camera).success);
}

TEST(PoseOptimizer, fails_when_all_points_are_the_same) {
  Scene scene = make_scene(1, 0.0);
  scene.observations.resize(30, scene.observations.front());
  EXPECT_FALSE(optimize_pose(kCamera, scene.observations, scene.T_world_camera).success);
}

TEST(PoseOptimizer, points_behind_the_camera_are_outliers) {
  Scene scene = make_scene(60, 0.1);
  for (std::size_t i = 0; i < 15; ++i) {
    const Eigen::Vector3d p_camera = scene.T_world_camera.inverse() * scene.observations[i].p_world;
    scene.observations[i].p_world = scene.T_world_camera * Eigen::Vector3d(-p_camera);
  }
  const auto result = optimize_pose(kCamera, scene.observations, disturbed(scene.T_world_camera));
  ASSERT_TRUE(result.success);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_FALSE(result.inlier[i]);
  EXPECT_LT((result.T_world_camera.inverse() * scene.T_world_camera).translation().norm(), 2e-3);
}

TEST(PoseJacobian, agrees_with_central_differences) {
  const Eigen::Vector3d p_world(0.3, -0.4, 2.0), t(0.1, 0.2, 0.3);
  const RgbdMeasurement measured{{300, 200}, 2.2};
  const geometry::Vector6d x0 = (geometry::Vector6d() << 0.02, -0.03, 0.05, 0.3, -0.2, 0.4).finished();
  const auto residual = [&](const geometry::Vector6d& x) -> Eigen::Vector3d {
    const Eigen::Vector3d p_camera = geometry::so3_exp(x.tail<3>()) * p_world + t + x.head<3>();
    return rgbd_residual(kCamera, p_camera, measured);
  };
  const Eigen::Vector3d p_rotated = geometry::so3_exp(x0.tail<3>()) * p_world;
  const auto analytic = pose_jacobian(kCamera, p_rotated, p_rotated + t + x0.head<3>(),
                                      geometry::so3_left_jacobian(x0.tail<3>()), measured);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const geometry::Vector6d step = kStep * geometry::Vector6d::Unit(i);
    const Eigen::Vector3d numeric = (residual(x0 + step) - residual(x0 - step)) / (2 * kStep);
    EXPECT_LT((analytic.col(i) - numeric).norm(), 1e-4 * std::max(1.0, numeric.norm())) << "column " << i;
  }
}

TEST(PoseCost, has_the_descent_of_its_own_differences_whatever_the_loss) {
  const Scene scene = make_scene(40, 3.0);
  const geometry::Vector6d x = (geometry::Vector6d() << 0.02, -0.03, 0.05, 0.03, -0.02, 0.04).finished();
  PoseOptimizerOptions turned;
  turned.rotation = RotationPrior{scene.T_world_camera.linear(), 1e-4 * Eigen::Matrix3d::Identity()};
  const std::pair<PoseOptimizerOptions, std::optional<GeneralLoss>> cases[] = {
      {{}, {}}, {turned, {}}, {{}, GeneralLoss{.shape = 1, .scale2 = 2}}};
  for (const auto& [options, loss] : cases) {
    for (const bool robust : {false, true}) {
      PoseCost cost(kCamera, scene.T_world_camera.inverse(), options, robust, loss);
      for (const PoseObservation& observation : scene.observations) cost.add(observation);
      const NormalEquations equations = cost.linearize(x);
      EXPECT_NEAR(equations.squared, cost.squared(x), 1e-9 * equations.squared);
      for (int i = 0; i < 6; ++i) {
        const geometry::Vector6d step = 1e-6 * geometry::Vector6d::Unit(i);
        const double slope = (cost.squared(x + step) - cost.squared(x - step)) / 2e-6;
        EXPECT_NEAR(-2 * equations.descent[i], slope, 1e-4 * equations.descent.norm()) << "parameter " << i;
      }
    }
  }
}

TEST(PoseCost, has_the_hessian_of_the_jacobians_of_its_points) {
  const Scene scene = make_scene(40, 1.0);
  const PoseOptimizerOptions options;
  const Eigen::Isometry3d T_camera_world = scene.T_world_camera.inverse();
  PoseCost cost(kCamera, T_camera_world, options, false, {});
  const geometry::Vector6d x = (geometry::Vector6d() << 0.02, -0.03, 0.05, 0.3, -0.2, 0.4).finished();
  const Eigen::Matrix3d left_jacobian = geometry::so3_left_jacobian(x.tail<3>());
  geometry::Matrix6d expected = geometry::Matrix6d::Zero();
  for (const PoseObservation& o : scene.observations) {
    cost.add(o);
    const Eigen::Vector3d p_rotated = geometry::so3_exp(x.tail<3>()) * T_camera_world.linear() * o.p_world;
    const auto J = pose_jacobian(kCamera, p_rotated, p_rotated + T_camera_world.translation() + x.head<3>(),
                                 left_jacobian, o.measured);
    expected += J.transpose() * J;
  }
  EXPECT_LT((cost.linearize(x).hessian - expected).norm(), 1e-10 * expected.norm());
}

/// Bearings of a wall 4 m away: a way to the side and a turn look nearly alike.
TEST(PoseOptimizer, a_known_rotation_holds_what_the_image_leaves_free) {
  double sum_nees = 0, sigma_alone_m = 0, sigma_known_m = 0;
  constexpr int kRuns = 60;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> u(250, 390), v(170, 310), depth(3.8, 4.2);
    std::normal_distribution<double> noise(0.0, 1.0);
    const Eigen::Isometry3d truth = make_pose((geometry::Vector6d() << 0.02, 0, 0, 0, 0.01, 0).finished());
    std::vector<PoseObservation> observations(60);
    for (PoseObservation& o : observations) {
      const double z = depth(random);
      const Eigen::Vector2d pixel{u(random), v(random)};
      o.p_world = truth * Eigen::Vector3d((pixel.x() - kCamera.cx) / kCamera.fx * z,
                                          (pixel.y() - kCamera.cy) / kCamera.fy * z, z);
      o.measured.pixel = pixel + Eigen::Vector2d{noise(random), noise(random)};
    }
    const auto alone = optimize_pose(kCamera, observations, truth);
    PoseOptimizerOptions options;
    constexpr double kSigma_rad = 1e-3;
    const Eigen::Vector3d off_rad = kSigma_rad * Eigen::Vector3d{noise(random), noise(random), noise(random)};
    options.rotation = RotationPrior{truth.linear() * geometry::so3_exp(off_rad),
                                     kSigma_rad * kSigma_rad * Eigen::Matrix3d::Identity()};
    const auto known = optimize_pose(kCamera, observations, truth, options);
    ASSERT_TRUE(alone.success && known.success);
    sigma_alone_m += std::sqrt(alone.covariance(0, 0)) / kRuns;
    sigma_known_m += std::sqrt(known.covariance(0, 0)) / kRuns;
    geometry::Vector6d error;
    error << known.T_world_camera.translation() - truth.translation(),
        geometry::so3_log(known.T_world_camera.linear() * truth.linear().transpose());
    sum_nees += error.dot(known.covariance.inverse() * error);
  }
  EXPECT_GT(sigma_alone_m, 5 * sigma_known_m);
  EXPECT_LT(sigma_known_m, 0.01) << "m";
  EXPECT_NEAR(sum_nees / kRuns, 6, 2);
}

std::vector<SquaredResidual> make_residuals(double sigma, double outlier_share) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SquaredResidual> residuals;
  for (int i = 0; i < 2000; ++i) {
    const int dimension = i % 3 == 0 ? 2 : 3;
    const double scale = unit(random) < outlier_share ? 6 * sigma : sigma;
    double chi2 = 0;
    for (int k = 0; k < dimension; ++k) chi2 += std::pow(scale * normal(random), 2);
    residuals.push_back({chi2, dimension});
  }
  return residuals;
}

TEST(GeneralLoss, begins_as_the_square_and_slope_is_its_derivative) {
  for (const double shape : {2.0, 1.5, 1.0, 0.5, 0.0, -2.0}) {
    const GeneralLoss loss{shape, 0.6};
    EXPECT_NEAR(loss(1e-4).rho, 1e-4, 1e-7) << shape;
    for (const double s : {0.1, 2.0, 50.0}) {
      const double step = 1e-5 * s;
      EXPECT_NEAR(loss(s).slope, (loss(s + step).rho - loss(s - step).rho) / (2 * step), 1e-6) << shape;
    }
  }
}

TEST(GeneralLoss, finds_the_scale_of_clean_residuals_and_calls_them_gaussian) {
  for (const double sigma : {0.6, 1.0, 1.8}) {
    const GeneralLoss loss = fit_general_loss(make_residuals(sigma, 0), {});
    EXPECT_NEAR(loss.scale2, sigma * sigma, 0.1 * sigma * sigma);
    EXPECT_GE(loss.shape, 1.5);
  }
}

TEST(GeneralLoss, heavier_tails_give_smaller_shapes) {
  const double clean = fit_general_loss(make_residuals(1, 0), {}).shape;
  const double some = fit_general_loss(make_residuals(1, 0.1), {}).shape;
  const double many = fit_general_loss(make_residuals(1, 0.3), {}).shape;
  EXPECT_LT(some, clean);
  EXPECT_LE(many, some);
}

TEST(GeneralLoss, few_residuals_change_nothing) {
  const std::vector<SquaredResidual> few(5, SquaredResidual{3.0, 3});
  EXPECT_EQ(fit_general_loss(few, {0.5, 2.0}).shape, 0.5);
  EXPECT_EQ(fit_general_loss({}, {0.5, 2.0}).scale2, 2.0);
}

}  // namespace
}  // namespace rtd::vision
