// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/floor_plane.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

#include "common/vision/samples.hpp"

namespace rtd::slam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kMaxTilt_rad = 40 * kRadPerDeg, kMaxSigma_rad = 0.5 * kRadPerDeg;
constexpr double kMaxDrawnTilt_rad = 52 * kRadPerDeg;  // or the limit would cut a slanting one to its own angle
constexpr double kSharedError = 3;                     // neighbours share errors of the depth
constexpr int kMinPoints = 40;
constexpr double kMinShare = 0.06;  // of all points: less may be a shelf
constexpr double kMinWidth_m = 0.2;
constexpr double kMaxShareBelow = 0.15;

/// up_camera . p = -height_m.
struct Plane {
  Eigen::Vector3d up;
  double height_m;
  double above_m(const Eigen::Vector3d& p) const { return up.dot(p) + height_m; }
};

/// Standard deviation of a point's distance to a plane with this normal: the depth of a camera is off by a share of its
/// square, along the viewing ray.
double sigma_m(const Eigen::Vector3d& p, const Eigen::Vector3d& up) {
  constexpr double kFlat_m = 0.005, kDepth_per_m = 0.003;
  return std::hypot(kFlat_m, kDepth_per_m * p.z() * up.dot(p));
}

constexpr double kOnPlane = 3, kBelow = 6;  // sigmas

struct Support {
  int on = 0, below = 0;
  bool is_lowest() const { return below <= kMaxShareBelow * on; }
};

Support support_of(const Plane& plane, const std::vector<Eigen::Vector3d>& points) {
  Support support;
  for (const Eigen::Vector3d& p : points) {
    const double sigmas = plane.above_m(p) / sigma_m(p, plane.up);
    if (std::abs(sigmas) < kOnPlane) ++support.on;
    if (sigmas < -kBelow) ++support.below;
  }
  return support;
}

/// Through three of the points, drawn so often that a floor on a tenth of them is met a few times.
std::optional<Plane> best_of_draws(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& expected_up) {
  constexpr int kDraws = 8000;
  constexpr double kMinArea_m2 = 0.02;
  const double min_cosine = std::cos(kMaxDrawnTilt_rad);
  std::mt19937_64 random(1);
  const auto draw = [&]() -> const Eigen::Vector3d& { return points[random() % points.size()]; };
  std::optional<Plane> best;
  int best_on = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d &a = draw(), &b = draw(), &c = draw();
    Eigen::Vector3d normal = (b - a).cross(c - a);
    const double area_m2 = normal.norm();
    if (!(area_m2 > kMinArea_m2)) continue;
    normal *= (normal.dot(expected_up) < 0 ? -1 : 1) / area_m2;
    if (normal.dot(expected_up) < min_cosine) continue;
    const Plane plane{normal, -normal.dot(a)};
    const Support support = support_of(plane, points);
    if (support.on <= best_on || !support.is_lowest() || plane.height_m <= 0) continue;
    best = plane;
    best_on = support.on;
  }
  return best;
}

/// Least squares of the points on the plane, weighted by their noise, with how well that knows the direction.
std::optional<FloorPlane> refine(Plane plane, const std::vector<Eigen::Vector3d>& points) {
  constexpr int kIterations = 5;
  FloorPlane floor;
  double width_m = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double weights = 0, chi2 = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    floor.points = 0;
    for (const Eigen::Vector3d& p : points) {
      const double sigma = sigma_m(p, plane.up), sigmas = plane.above_m(p) / sigma, weight = 1 / (sigma * sigma);
      if (std::abs(sigmas) >= kOnPlane) continue;
      weights += weight, chi2 += sigmas * sigmas, ++floor.points;
      mean += weight * p, squares += weight * p * p.transpose();
    }
    if (floor.points < kMinPoints) return std::nullopt;
    mean /= weights;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares - weights * mean * mean.transpose());
    const Eigen::Vector3d normal = axes.eigenvectors().col(0);
    plane.up = normal.dot(plane.up) < 0 ? Eigen::Vector3d(-normal) : normal;
    plane.height_m = -plane.up.dot(mean);
    floor.sigma_rad = kSharedError * std::sqrt(std::max(1.0, chi2 / floor.points) / axes.eigenvalues()[1]);
    width_m = std::sqrt(axes.eigenvalues()[1] / weights);
  }
  floor.up_camera = plane.up;
  floor.height_m = plane.height_m;
  if (!(floor.sigma_rad < kMaxSigma_rad && width_m > kMinWidth_m)) return std::nullopt;
  return floor;
}

}  // namespace

std::optional<FloorPlane> find_floor(const std::vector<Eigen::Vector3d>& points_camera,
                                     const Eigen::Vector3d& expected_up_camera) {
  constexpr std::size_t kEnough = 500;
  if (points_camera.size() < kMinPoints) return std::nullopt;
  const std::optional<Plane> plane = best_of_draws(vision::thin_out(points_camera, kEnough), expected_up_camera);
  if (!plane) return std::nullopt;
  std::optional<FloorPlane> floor = refine(*plane, points_camera);
  if (!floor) return std::nullopt;
  const Support support = support_of({floor->up_camera, floor->height_m}, points_camera);
  const bool large = support.on >= kMinShare * static_cast<double>(points_camera.size());
  const bool upright = floor->up_camera.dot(expected_up_camera) >= std::cos(kMaxTilt_rad);
  return large && upright && support.is_lowest() && floor->height_m > 0 ? floor : std::nullopt;
}

}  // namespace rtd::slam
