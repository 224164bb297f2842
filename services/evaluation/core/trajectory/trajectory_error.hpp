// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "common/geometry/trajectory.hpp"

namespace rtd::eval {

/// How far an estimated motion is from the true one.
struct StepError {
  double translation_m = 0, rotation_rad = 0;
};

/// A motion between two moments: the poses at both, in any world.
struct Step {
  const Eigen::Isometry3d &T_world_from, &T_world_to;
};

/// docs/evaluation.md Eq. (6)-(8). With `scale`, the translation of the estimate is multiplied by it first.
StepError step_error(const Step& estimate, const Step& groundtruth, double scale = 1);

/// Index of the entry nearest to `value` in an ordered, non-empty list; the earlier one when two are equally near.
template <class T>
std::size_t nearest_index(const std::vector<T>& ordered, T value) {
  const auto above = std::ranges::lower_bound(ordered, value);
  if (above == ordered.begin()) return 0;
  const auto index = static_cast<std::size_t>(above - ordered.begin());
  if (above == ordered.end()) return index - 1;
  return value - ordered[index - 1] <= ordered[index] - value ? index - 1 : index;
}

/// Ground truth by time. The trajectory must outlive it and not be empty.
class GroundtruthLookup {
 public:
  /// `offset_s` is added to the stamps of the estimate.
  GroundtruthLookup(const geometry::Trajectory& groundtruth, double offset_s);

  /// Pose nearest to an estimate's stamp; null when ground truth has a gap there (twice its median interval).
  const Eigen::Isometry3d* find(std::int64_t estimate_ns) const;

 private:
  const geometry::Trajectory& groundtruth_;
  std::vector<std::int64_t> stamps_ns_;
  std::int64_t offset_ns_, max_difference_ns_;
};

using geometry::read_frame_stamps;
using geometry::StampedPose;
using geometry::stamps_of;
using geometry::Trajectory;
using geometry::TrajectoryError;

inline constexpr double kRadToDeg = 180 / std::numbers::pi;

inline double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

/// Summary of a set of non-negative errors, in their unit. All NaN when count is 0.
struct Statistics {
  std::size_t count = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  double std_dev = std::numeric_limits<double>::quiet_NaN();  ///< of the population (divided by count)
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

Statistics summarize(const std::vector<double>& values);

/// Value below which a fraction (in [0, 1]) of the values lies, linear between neighbours. NaN when there are none.
double percentile(std::vector<double> values, double fraction);

struct AssociationOptions {
  double max_difference_s = 0.02;  ///< pairs must be closer than this
  double offset_s = 0;             ///< added to the stamps of the estimate
};

enum class AlignmentKind { kRigid, kSimilarity };  ///< SE(3) or Sim(3)

/// Maps points of the estimate's world into the ground truth's: p_gt = scale * R * p_est + t.
struct Alignment {
  double scale = 1;
  Eigen::Isometry3d T_groundtruth_estimate = Eigen::Isometry3d::Identity();
  bool unique = true;  ///< false: too few points or all on one line; the rotation is one of many equally good

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_estimate) const {
    return scale * (T_groundtruth_estimate.linear() * p_estimate) + T_groundtruth_estimate.translation();
  }
};

/// Least-squares alignment of paired points in closed form (Horn 1987; Umeyama 1991 Eq. 40-42), docs/evaluation.md Eq.
/// (2)-(4). Column k of both matrices is one moment, metres. Any number of points works; none gives the identity.
Alignment align(const Eigen::Matrix3Xd& estimate_m, const Eigen::Matrix3Xd& groundtruth_m, AlignmentKind kind);

struct AteOptions {
  AssociationOptions association;
  AlignmentKind alignment = AlignmentKind::kRigid;
};

/// One associated moment after alignment.
struct AtePoint {
  std::int64_t stamp_ns = 0;  ///< of the estimate
  Eigen::Vector3d groundtruth_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_m = Eigen::Vector3d::Zero();  ///< in the ground truth's world
  double error_m = 0;                                    ///< distance of the two
};

struct AteResult {
  Statistics error_m;  ///< count 0: nothing associated
  Alignment alignment;
  std::vector<AtePoint> points;
};

/// The stamps of an estimate on the ground truth's clock.
std::vector<std::int64_t> shifted_stamps(const Trajectory& estimate, double offset_s);

/// Absolute trajectory error: geometry::associate(), align, distances of positions. docs/evaluation.md Eq. (1)-(5).
AteResult ate(const Trajectory& estimate, const Trajectory& groundtruth, const AteOptions& options = {});

/// What the step between the two poses of a pair is measured in.
enum class RpeUnit { kSeconds, kFrames, kMetres };

struct RpeOptions {
  double delta = 1;  ///< step, in `unit`
  RpeUnit unit = RpeUnit::kSeconds;
  double offset_s = 0;  ///< added to the stamps of the estimate
  double scale = 1;     ///< applied to the estimate's translations (Sim(3) alignment)
};

struct RpeResult {
  Statistics translation_m, rotation_rad;  ///< count 0: no step fits
};

/// Relative pose errors as TUM's evaluate_rpe.py with --fixed_delta: from every estimated pose to the one nearest to
/// `delta` later (frames and metres count along the estimate), compared with the ground-truth poses nearest in time.
/// Steps that reach the last pose and steps without ground truth within twice its median interval are left out.
/// docs/evaluation.md Eq. (6)-(8).
std::vector<StepError> relative_errors(const Trajectory& estimate, const Trajectory& groundtruth,
                                       const RpeOptions& options = {});
/// Their statistics.
RpeResult rpe(const Trajectory& estimate, const Trajectory& groundtruth, const RpeOptions& options = {});

}  // namespace rtd::eval
