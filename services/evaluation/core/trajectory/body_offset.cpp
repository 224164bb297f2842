// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/body_offset.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>

#include "common/geometry/se3.hpp"

namespace rtd::eval {
namespace {

constexpr double kSpan_s = 1;
constexpr int kRounds = 4;           ///< the last ones without motions that fit badly: the estimate may have jumped
constexpr double kOutlier = 3;       ///< times the median
constexpr double kSecondAxis = 0.1;  ///< share of the turns about the second axis, as a standard deviation
constexpr double kLeastTurn_rad = 2 / kRadToDeg, kLeastWay_m = 0.02;
constexpr double kPlain = 0.5;  ///< the errors fall below this share

/// What body and camera did in the same time.
struct MotionPair {
  Eigen::Isometry3d T_body_from_to, T_camera_from_to;
};
using MotionPairs = std::vector<MotionPair>;

MotionPairs motion_pairs(const Trajectory& estimate, const Trajectory& groundtruth, double offset_s, double scale) {
  MotionPairs pairs;
  if (estimate.empty() || groundtruth.empty()) return pairs;
  const GroundtruthLookup lookup(groundtruth, offset_s);
  const std::vector<std::int64_t> stamps_ns = stamps_of(estimate);
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::int64_t wanted_ns = stamps_ns[i] + std::llround(kSpan_s * 1e9);
    if (wanted_ns > stamps_ns.back()) break;
    const std::size_t j = nearest_index(stamps_ns, wanted_ns);
    const Eigen::Isometry3d* T_world_from = lookup.find(stamps_ns[i]);
    const Eigen::Isometry3d* T_world_to = lookup.find(stamps_ns[j]);
    if (T_world_from == nullptr || T_world_to == nullptr) continue;
    pairs.push_back(
        {T_world_from->inverse() * *T_world_to, estimate[i].T_world_body.inverse() * estimate[j].T_world_body});
    pairs.back().T_camera_from_to.translation() *= scale;
  }
  return pairs;
}

StepError error_of(const MotionPair& pair, const Eigen::Isometry3d& T_body_camera) {
  const Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d T_true = T_body_camera.inverse() * pair.T_body_from_to * T_body_camera;
  return step_error({start, pair.T_camera_from_to}, {start, T_true});
}

/// Median over all pairs.
StepError median_error(const MotionPairs& pairs, const Eigen::Isometry3d& T_body_camera) {
  std::vector<double> ways_m, turns_rad;
  for (const MotionPair& pair : pairs) {
    const StepError error = error_of(pair, T_body_camera);
    ways_m.push_back(error.translation_m);
    turns_rad.push_back(error.rotation_rad);
  }
  return {percentile(ways_m, 0.5), percentile(turns_rad, 0.5)};
}

/// R with log A = R log B. The turns and their opposites together have mean zero, as the alignment of points wants it.
Eigen::Matrix3d fit_turn(const MotionPairs& pairs) {
  Eigen::Matrix3Xd camera(3, 2 * pairs.size()), body(3, 2 * pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(2 * i);
    camera.col(column) = geometry::so3_log(pairs[i].T_camera_from_to.linear());
    body.col(column) = geometry::so3_log(pairs[i].T_body_from_to.linear());
    camera.col(column + 1) = -camera.col(column);
    body.col(column + 1) = -body.col(column);
  }
  return align(camera, body, AlignmentKind::kRigid).T_groundtruth_estimate.linear();
}

/// t with (R_A - I) t = R t_B - t_A, by least squares.
Eigen::Vector3d fit_lever_arm(const MotionPairs& pairs, const Eigen::Matrix3d& R_body_camera) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const MotionPair& pair : pairs) {
    const Eigen::Matrix3d turn = pair.T_body_from_to.linear() - Eigen::Matrix3d::Identity();
    normal += turn.transpose() * turn;
    right +=
        turn.transpose() * (R_body_camera * pair.T_camera_from_to.translation() - pair.T_body_from_to.translation());
  }
  return normal.ldlt().solve(right);
}

/// Pairs whose error is not far above the median.
MotionPairs without_outliers(const MotionPairs& pairs, const Eigen::Isometry3d& T_body_camera) {
  const StepError median = median_error(pairs, T_body_camera);
  MotionPairs kept;
  for (const MotionPair& pair : pairs) {
    const StepError error = error_of(pair, T_body_camera);
    if (error.rotation_rad <= kOutlier * median.rotation_rad && error.translation_m <= kOutlier * median.translation_m)
      kept.push_back(pair);
  }
  return kept;
}

Eigen::Isometry3d fit(const MotionPairs& pairs, bool turned) {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  MotionPairs fitting = pairs;
  for (int round = 0; round < kRounds && !fitting.empty(); ++round) {
    if (turned) T_body_camera.linear() = fit_turn(fitting);
    T_body_camera.translation() = fit_lever_arm(fitting, T_body_camera.linear());
    fitting = without_outliers(pairs, T_body_camera);
  }
  return T_body_camera;
}

/// Turns about one axis alone leave the turn about it, and the way along it, open.
bool turns_about_two_axes(const MotionPairs& pairs) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const MotionPair& pair : pairs) {
    const Eigen::Vector3d turn = geometry::so3_log(pair.T_body_from_to.linear());
    spread += turn * turn.transpose();
  }
  const Eigen::Vector3d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  return squares[1] > kSecondAxis * kSecondAxis * squares[2];
}

/// T_ros T_m of the dataset's page, whose rows are 1.059 long.
bool is_bonn(const Eigen::Matrix3d& R_body_camera) {
  Eigen::Matrix3d published;
  published << -1.0157, -0.1828, 0.2389, -0.3009, 0.6147, -0.8085, 0.0009, -0.8431, -0.6413;
  const Eigen::Matrix3d R_bonn = published / std::cbrt(published.determinant());
  return Eigen::AngleAxisd(R_bonn.transpose() * R_body_camera).angle() < 5 / kRadToDeg;
}

}  // namespace

std::optional<BodyOffset> find_body_offset(const Trajectory& estimate, const Trajectory& groundtruth, double offset_s,
                                           double scale) {
  constexpr std::size_t kFewestPairs = 30;
  const MotionPairs pairs = motion_pairs(estimate, groundtruth, offset_s, scale);
  if (pairs.size() < kFewestPairs || !turns_about_two_axes(pairs)) return std::nullopt;
  const StepError before = median_error(pairs, Eigen::Isometry3d::Identity());
  const Eigen::Isometry3d turned = fit(pairs, true), shifted = fit(pairs, false);
  if (geometry::rotation_angle_rad(turned) > kLeastTurn_rad &&
      median_error(pairs, turned).rotation_rad < kPlain * before.rotation_rad) {
    return BodyOffset{turned, is_bonn(turned.linear())};
  }
  if (shifted.translation().norm() > kLeastWay_m &&
      median_error(pairs, shifted).translation_m < kPlain * before.translation_m) {
    return BodyOffset{shifted};
  }
  return std::nullopt;
}

Trajectory camera_truth(const Trajectory& groundtruth, const std::optional<BodyOffset>& offset) {
  Trajectory poses = groundtruth;
  if (!offset) return poses;
  for (StampedPose& pose : poses) pose.T_world_body = pose.T_world_body * offset->T_body_camera;
  return poses;
}

std::string explain(const BodyOffset& offset) {
  return fmt::format(
      "the ground truth is of another body{}: the camera is turned by {:.1f} degrees and {:.3f} m away from it, as the "
      "motions of both show; this is taken into account in RPE, drift and integrity, not in the ATE",
      offset.of_bonn ? " (the markers of the Bonn RGB-D Dynamic Dataset)" : "",
      geometry::rotation_angle_rad(offset.T_body_camera) * kRadToDeg, offset.T_body_camera.translation().norm());
}

}  // namespace rtd::eval
