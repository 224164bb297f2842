// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/optimize/bundle_adjustment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/se3.hpp"
#include "tests/support/bundle_scene.hpp"

namespace rtd::slam {
namespace {

using geometry::Vector6d;

const vision::RgbdProjection kCamera{520.0, 521.0, 319.5, 239.5, 40.0};

struct Scene {
  BundleProblem truth, problem;
};

Vector6d twist(double tx, double ty, double tz, double rx, double ry, double rz) {
  return (Vector6d() << tx, ty, tz, rx, ry, rz).finished();
}

/// Five cameras around 150 points, two cameras fixed; every third observation without depth.
Scene make_scene(double noise_px) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> side(-1, 1), depth(1.5, 4);
  std::normal_distribution<double> normal(0, 1);
  Scene scene;
  scene.truth.camera = kCamera;
  for (int i = 0; i < 5; ++i) {
    scene.truth.cameras.push_back(
        {geometry::se3_exp(twist(0.1 * i, 0.05 * i, -0.03 * i, 0.02 * i, -0.04 * i, 0.03 * i)), i < 2});
  }
  for (int i = 0; i < 150; ++i) {
    const double z = depth(random);
    scene.truth.points.push_back(Eigen::Vector3d{0.4 * z * side(random), 0.3 * z * side(random), z});
  }
  for (std::uint32_t camera = 0; camera < 5; ++camera) {
    for (std::uint32_t point = 0; point < scene.truth.points.size(); ++point) {
      const Eigen::Vector3d p = scene.truth.cameras[camera].T_world_camera.inverse() * scene.truth.points[point];
      BundleObservation observation{camera, point, {}, 1.0, 1.0, true};
      observation.measured.pixel = {kCamera.fx * p.x() / p.z() + kCamera.cx + noise_px * normal(random),
                                    kCamera.fy * p.y() / p.z() + kCamera.cy + noise_px * normal(random)};
      if ((camera + point) % 3 != 0) {
        observation.measured.depth_m =
            kCamera.disparity_px_m / (kCamera.disparity_px_m / p.z() + noise_px * normal(random));
      }
      scene.truth.observations.push_back(observation);
    }
  }
  scene.problem = scene.truth;
  for (std::size_t i = 2; i < 5; ++i) {
    scene.problem.cameras[i].T_world_camera =
        scene.problem.cameras[i].T_world_camera * geometry::se3_exp(0.02 * twist(1, -1, 1, 0.5, 0.5, -0.5));
  }
  for (Eigen::Vector3d& point : scene.problem.points)
    point += 0.03 * Eigen::Vector3d{side(random), side(random), side(random)};
  return scene;
}

double camera_error_m(const Scene& scene, std::size_t camera) {
  return (scene.problem.cameras[camera].T_world_camera.inverse() * scene.truth.cameras[camera].T_world_camera)
      .translation()
      .norm();
}

/// The same scene as if every second camera had zoomed in.
void zoom_every_second(Scene& scene) {
  vision::RgbdProjection zoomed = kCamera;
  zoomed.fx *= 1.4;
  zoomed.fy *= 1.4;
  zoomed.cx += 12;
  for (std::size_t i = 1; i < scene.problem.cameras.size(); i += 2) scene.problem.cameras[i].intrinsics = zoomed;
  for (BundleObservation& observation : scene.problem.observations) {
    if (observation.camera % 2 == 0) continue;
    Eigen::Vector2d& pixel = observation.measured.pixel;
    pixel = {(pixel.x() - kCamera.cx) / kCamera.fx * zoomed.fx + zoomed.cx,
             (pixel.y() - kCamera.cy) / kCamera.fy * zoomed.fy + zoomed.cy};
  }
}

TEST(BundleAdjustment, each_camera_has_its_own_intrinsics) {
  for (const BundleSolver solver : {BundleSolver::kDense, BundleSolver::kSparse}) {
    Scene scene = make_scene(0);
    zoom_every_second(scene);
    BundleOptions options;
    options.solver = solver;
    options.iterations_robust = options.iterations = 10;
    EXPECT_EQ(adjust_bundle(scene.problem, options).outliers, 0);
    for (std::size_t i = 2; i < 5; ++i) {
      const Eigen::Isometry3d T_error =
          scene.problem.cameras[i].T_world_camera.inverse() * scene.truth.cameras[i].T_world_camera;
      EXPECT_LT(T_error.translation().norm(), 1e-4) << "camera " << i;
    }
  }
}

TEST(BundleAdjustment, recovers_a_disturbed_scene) {
  Scene scene = make_scene(0.0);
  const BundleSummary summary = adjust_bundle(scene.problem, {20, 20});
  EXPECT_LT(summary.final_cost, 1e-6);
  EXPECT_EQ(summary.outliers, 0);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LT(camera_error_m(scene, i), 1e-5) << "camera " << i;  // m
  for (std::size_t i = 0; i < scene.truth.points.size(); ++i) {
    EXPECT_LT((scene.problem.points[i] - scene.truth.points[i]).norm(), 1e-4) << "point " << i;  // m
  }
}

TEST(BundleAdjustment, few_iterations_are_enough_with_noise) {
  Scene scene = make_scene(0.5);
  adjust_bundle(scene.problem, {5, 5});
  for (std::size_t i = 2; i < 5; ++i) EXPECT_LT(camera_error_m(scene, i), 5e-3) << "camera " << i;
}

TEST(BundleAdjustment, fixed_cameras_do_not_move) {
  Scene scene = make_scene(0.5);
  adjust_bundle(scene.problem, {5, 5});
  EXPECT_TRUE(scene.problem.cameras[0].T_world_camera.matrix() == scene.truth.cameras[0].T_world_camera.matrix());
  EXPECT_TRUE(scene.problem.cameras[1].T_world_camera.matrix() == scene.truth.cameras[1].T_world_camera.matrix());
}

TEST(BundleAdjustment, holds_the_first_camera_when_none_is_fixed) {
  Scene scene = make_scene(0.0);
  for (BundleCamera& camera : scene.problem.cameras) camera.fixed = false;
  adjust_bundle(scene.problem, {20, 20});
  EXPECT_TRUE(scene.problem.cameras[0].T_world_camera.matrix() == scene.truth.cameras[0].T_world_camera.matrix());
  for (std::size_t i = 1; i < 5; ++i) EXPECT_LT(camera_error_m(scene, i), 1e-4);
}

TEST(BundleAdjustment, marks_outliers_and_is_not_bent_by_them) {
  Scene scene = make_scene(0.2);
  for (std::size_t i = 310; i < scene.problem.observations.size(); i += 7) {
    scene.problem.observations[i].measured.pixel.x() += 25;
  }
  adjust_bundle(scene.problem, {10, 10});
  int missed = 0;
  for (std::size_t i = 310; i < scene.problem.observations.size(); i += 7)
    missed += scene.problem.observations[i].inlier ? 1 : 0;
  EXPECT_EQ(missed, 0);
  for (std::size_t i = 2; i < 5; ++i) EXPECT_LT(camera_error_m(scene, i), 3e-3);
}

TEST(BundleAdjustment, weights_decide_between_contradicting_observations) {
  Scene scene = make_scene(0.0);
  for (BundleObservation& observation : scene.problem.observations) {
    if (observation.camera < 2 || observation.point % 2 == 0) continue;
    observation.measured.pixel.y() += 1.5;  // half of what the free cameras see has moved
    observation.weight = 1e-3;
  }
  adjust_bundle(scene.problem, {20, 0});
  for (std::size_t i = 2; i < 5; ++i) EXPECT_LT(camera_error_m(scene, i), 2e-4);
}

test_support::BundleScene make_local_scene(std::uint64_t seed = 1) {
  test_support::BundleSceneOptions options;
  options.seed = seed;
  options.keyframes = 8;
  options.fixed_keyframes = 2;
  options.landmarks = 400;
  return test_support::make_bundle_scene(options);
}

TEST(BundleAdjustment, own_solver_finds_the_minimum_that_ceres_finds) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    test_support::BundleScene dense = make_local_scene(seed), sparse = dense;
    BundleOptions options{30, 0};
    const BundleSummary own = adjust_bundle(dense.problem, options);
    options.solver = BundleSolver::kSparse;
    const BundleSummary ceres = adjust_bundle(sparse.problem, options);
    EXPECT_NEAR(own.initial_cost, ceres.initial_cost, 1e-9 * ceres.initial_cost) << seed;
    EXPECT_NEAR(own.final_cost, ceres.final_cost, 5e-4 * ceres.final_cost) << seed;
    EXPECT_NEAR(own.outliers, ceres.outliers, 3) << seed;
    for (std::size_t i = 0; i < dense.problem.cameras.size(); ++i) {
      const Eigen::Isometry3d T_own_ceres =
          dense.problem.cameras[i].T_world_camera.inverse() * sparse.problem.cameras[i].T_world_camera;
      EXPECT_LT(T_own_ceres.translation().norm(), 2e-4) << "seed " << seed << ", camera " << i;  // m
    }
  }
}

TEST(BundleAdjustment, an_interrupt_keeps_what_is_reached) {
  const test_support::BundleScene scene = make_local_scene();
  int questions = 0;
  BundleOptions options{5, 0};
  options.interrupted = [&] { return ++questions < 0; };
  test_support::BundleScene whole = scene;
  const BundleSummary reached = adjust_bundle(whole.problem, options);
  EXPECT_GT(questions, 60) << "asked every 32 of 400 landmarks, twice an iteration";
  double last_cost = std::numeric_limits<double>::infinity();
  for (int raised_at = 20; raised_at <= questions; raised_at += 8) {
    test_support::BundleScene interrupted = scene;
    int asked = 0;
    options.interrupted = [&] { return ++asked >= raised_at; };
    const BundleSummary summary = adjust_bundle(interrupted.problem, options);
    EXPECT_LE(summary.final_cost, last_cost) << "the later, the better";
    last_cost = summary.final_cost;
  }
  EXPECT_NEAR(last_cost, reached.final_cost, 1e-4 * last_cost);
}

TEST(BundleAdjustment, moves_points_alone_when_all_cameras_are_fixed) {
  Scene scene = make_scene(0.0);
  scene.problem.cameras = scene.truth.cameras;
  for (BundleCamera& camera : scene.problem.cameras) camera.fixed = true;
  adjust_bundle(scene.problem, {20, 0});
  for (std::size_t i = 0; i < scene.truth.points.size(); ++i) {
    EXPECT_LT((scene.problem.points[i] - scene.truth.points[i]).norm(), 1e-4) << "point " << i;  // m
  }
}

TEST(BundleAdjustment, survives_points_behind_and_at_the_camera) {
  Scene scene = make_scene(0.2);
  scene.problem.points[0].z() = -2;
  scene.problem.points[1].setZero();
  const BundleSummary summary = adjust_bundle(scene.problem, {10, 0});
  EXPECT_TRUE(std::isfinite(summary.final_cost));
  for (std::size_t i = 2; i < 5; ++i) EXPECT_LT(camera_error_m(scene, i), 1e-2) << "camera " << i;
}

TEST(BundleAdjustment, ends_early_when_interrupted) {
  Scene scene = make_scene(0.0);
  BundleOptions options{50, 50};
  int asked = 0;
  options.interrupted = [&] { return ++asked >= 3; };
  EXPECT_LE(adjust_bundle(scene.problem, options).iterations, 4);
}

TEST(BundleAdjustment, survives_an_empty_problem) {
  BundleProblem problem;
  problem.camera = kCamera;
  EXPECT_EQ(adjust_bundle(problem, {}).outliers, 0);
}

class BundleJacobian : public ::testing::TestWithParam<double> {};

TEST_P(BundleJacobian, agrees_with_central_differences) {
  const Eigen::Isometry3d T_camera_world = geometry::se3_exp(twist(0.1, -0.2, 0.3, 0.2, 0.1, -0.3));
  BundleObservation observation{0, 0, {{310, 250}, GetParam()}, 1.44, 1.0, true};
  const int dimension = observation.measured.dimension();
  const Vector6d pose0 = twist(0.02, 0.01, -0.03, 0.2, -0.1, 0.15);
  const Eigen::Vector3d point0(0.2, -0.1, 2.1);
  std::array<double, 3> residual{};
  std::array<double, 18> jacobian_pose{};
  std::array<double, 9> jacobian_point{};
  evaluate_bundle_residual(kCamera, T_camera_world, observation, pose0.data(), point0.data(), residual.data(),
                           jacobian_pose.data(), jacobian_point.data());
  constexpr double kStep = 1e-6;
  const auto numeric = [&](const Vector6d& pose_step, const Eigen::Vector3d& point_step, int row) {
    std::array<double, 3> plus{}, minus{};
    const Vector6d pose_plus = pose0 + pose_step, pose_minus = pose0 - pose_step;
    const Eigen::Vector3d point_plus = point0 + point_step, point_minus = point0 - point_step;
    evaluate_bundle_residual(kCamera, T_camera_world, observation, pose_plus.data(), point_plus.data(), plus.data(),
                             nullptr, nullptr);
    evaluate_bundle_residual(kCamera, T_camera_world, observation, pose_minus.data(), point_minus.data(), minus.data(),
                             nullptr, nullptr);
    return (plus[static_cast<std::size_t>(row)] - minus[static_cast<std::size_t>(row)]) / (2 * kStep);
  };
  for (int row = 0; row < dimension; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_NEAR(jacobian_pose[static_cast<std::size_t>(row * 6 + column)],
                  numeric(kStep * Vector6d::Unit(column), Eigen::Vector3d::Zero(), row), 1e-4);
    }
    for (int column = 0; column < 3; ++column) {
      EXPECT_NEAR(jacobian_point[static_cast<std::size_t>(row * 3 + column)],
                  numeric(Vector6d::Zero(), kStep * Eigen::Vector3d::Unit(column), row), 1e-4);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(WithAndWithoutDepth, BundleJacobian, ::testing::Values(0.0, 2.3));

}  // namespace
}  // namespace rtd::slam
