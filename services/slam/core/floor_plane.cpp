// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/floor_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>

#include "common/vision/samples.hpp"

namespace rtd::slam {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kMaxTilt_rad = 40 * kRadPerDeg, kMaxSigma_rad = 0.6 * kRadPerDeg;
constexpr double kMaxDrawnTilt_rad = 52 * kRadPerDeg;  // or the limit would cut a slanting one to its own angle
constexpr double kSharedError = 3;                     // neighbours share errors of the depth
constexpr int kMinPoints = 40;
constexpr double kMinShare = 0.06;  // of all points: less may be a shelf
constexpr double kMinWidth_m = 0.2;
constexpr double kMaxShareBelow = 0.03;

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
  const double of_depth_m = kDepth_per_m * p.z() * up.dot(p);
  return std::sqrt(kFlat_m * kFlat_m + of_depth_m * of_depth_m);
}

// Sigmas. A wider band takes the feet of walls and furniture for floor, which tilt it by half a degree.
constexpr double kOnPlane = 1.5, kNearPlane = 2 * kOnPlane;

struct Support {
  int on = 0, near = 0, below = 0;
  /// Nothing lies under a floor.
  bool is_lowest() const { return below <= kMaxShareBelow * on; }
  /// Not a cut through things of many heights, of which half of those near it would be on it.
  bool is_flat() const { return on >= 0.75 * near; }
};

Support support_of(const Plane& plane, const Points& points) {
  Support support;
  for (const Eigen::Vector3d& p : points) {
    const double sigmas = plane.above_m(p) / sigma_m(p, plane.up);
    if (std::abs(sigmas) < kOnPlane) ++support.on;
    if (std::abs(sigmas) < kNearPlane) ++support.near;
    if (sigmas < -kNearPlane) ++support.below;
  }
  return support;
}

/// Through three of the points, drawn so often that a floor on a tenth of them is met a few times.
std::optional<Plane> best_of_draws(const Points& points, const Eigen::Vector3d& expected_up) {
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

struct Fit {
  Plane plane;
  Eigen::Vector3d middle;     ///< of the points on it
  Eigen::Matrix3d axes;       ///< columns: its normal, where it is narrow, where it is long
  double sigma_rad, width_m;  ///< what noise does to its direction; the root mean square of where it is narrow
};

/// Least squares of the points on the plane, weighted by their noise.
Fit fit(Plane plane, const Points& points) {
  constexpr int kIterations = 5;
  Fit result{};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double weights = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : points) {
      const double sigma = sigma_m(p, plane.up), weight = 1 / (sigma * sigma);
      if (std::abs(plane.above_m(p)) >= kOnPlane * sigma) continue;
      weights += weight;
      mean += weight * p;
      squares += weight * p * p.transpose();
    }
    mean /= weights;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares - weights * mean * mean.transpose());
    const Eigen::Vector3d normal = axes.eigenvectors().col(0);
    plane.up = normal.dot(plane.up) < 0 ? Eigen::Vector3d(-normal) : normal;
    plane.height_m = -plane.up.dot(mean);
    result = {plane, mean, axes.eigenvectors(), kSharedError / std::sqrt(axes.eigenvalues()[1]),
              std::sqrt(axes.eigenvalues()[1] / weights)};
  }
  return result;
}

/// Standard deviation of the direction by the jackknife: each quarter of the plane is left out once. Things that lie on
/// the plane and errors of the depth that many points share turn it by more than noise. NaN if a fit fails.
double sigma_of_quarters(const Fit& all, const Points& points) {
  constexpr int kQuarters = 4;
  const auto quarter_of = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d along = all.axes.transpose() * (p - all.middle);
    return (along.y() > 0 ? 1 : 0) + (along.z() > 0 ? 2 : 0);
  };
  std::array<Eigen::Vector3d, kQuarters> ups;
  for (int quarter = 0; quarter < kQuarters; ++quarter) {
    Points rest;
    std::ranges::copy_if(points, std::back_inserter(rest), [&](const auto& p) { return quarter_of(p) != quarter; });
    ups[static_cast<std::size_t>(quarter)] = fit(all.plane, rest).plane.up;
  }
  const Eigen::Vector3d mean = (ups[0] + ups[1] + ups[2] + ups[3]) / kQuarters;
  double squares = 0;
  for (const Eigen::Vector3d& up : ups) squares += (up - mean).squaredNorm();
  return std::sqrt(squares * (kQuarters - 1) / kQuarters);
}

}  // namespace

std::optional<FloorPlane> find_floor(const Points& points_camera, const Eigen::Vector3d& expected_up_camera,
                                     double calibration_error) {
  constexpr std::size_t kEnough = 500;
  if (points_camera.size() < kMinPoints) return std::nullopt;
  const std::optional<Plane> drawn = best_of_draws(vision::thin_out(points_camera, kEnough), expected_up_camera);
  if (!drawn) return std::nullopt;
  const Fit floor = fit(*drawn, points_camera);
  const double sigma_rad = std::max(floor.sigma_rad, sigma_of_quarters(floor, points_camera));
  const Support support = support_of(floor.plane, points_camera);
  const bool large = support.on >= std::max<double>(kMinPoints, kMinShare * static_cast<double>(points_camera.size()));
  const bool upright = floor.plane.up.dot(expected_up_camera) >= std::cos(kMaxTilt_rad);
  const bool known = sigma_rad < kMaxSigma_rad && floor.width_m > kMinWidth_m;
  if (!large || !upright || !known || !support.is_lowest() || !support.is_flat() || floor.plane.height_m <= 0)
    return std::nullopt;
  return FloorPlane{floor.plane.up, floor.plane.height_m, std::hypot(sigma_rad, calibration_error), support.on};
}

}  // namespace rtd::slam
