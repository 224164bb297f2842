// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/trajectory.hpp"
#include "common/msg/tracking.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {

struct DriftOptions {
  double window_s = 1.0 / 3;  ///< ten frames of a camera at 30 Hz
  double least_m = 0.03;      ///< windows with a smaller error say nothing
  double offset_s = 0;        ///< added to the stamps of the estimate
  double scale = 1;           ///< applied to the estimate's translations (Sim(3) alignment)
};

/// How a trajectory drifts where it does: metres, degrees, and their quotient. A pose that follows something near pays
/// for its sideways movement with a turn that keeps what is far away in place; the quotient is then its distance.
/// docs/evaluation.md, "Drift". NaN where there are no windows.
struct Drift {
  std::size_t windows = 0;  ///< whose error is at least DriftOptions::least_m
  double median_m = std::numeric_limits<double>::quiet_NaN();
  double median_rad = std::numeric_limits<double>::quiet_NaN();
  double quotient_m_per_rad = std::numeric_limits<double>::quiet_NaN();  ///< median
  double lower_quartile_m_per_rad = std::numeric_limits<double>::quiet_NaN();
  double upper_quartile_m_per_rad = std::numeric_limits<double>::quiet_NaN();

  /// At least eight windows, and both quartiles within 15 % of the median.
  bool nearly_constant() const;
};

Drift measure_drift(const Trajectory& estimate, const Trajectory& groundtruth, const DriftOptions& options = {});

/// What a nearly constant quotient means, one sentence; empty for any other. With the depth of the scene it says
/// whether that is what stays in place.
std::string explain(const Drift& drift, const std::optional<double>& scene_depth_m = std::nullopt);

/// What was published of one frame, at the time: later corrections of the map do not count.
struct PublishedPose {
  std::int64_t stamp_ns = 0;
  msg::TrackingState state = msg::TrackingState::kInitializing;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< where msg::has_pose(state)
  std::optional<geometry::Matrix6d> covariance;  ///< (x y z rx ry rz), m and rad, world frame; none: not known
  std::uint32_t map_id = 0;                      ///< poses of different maps are not compared
};

/// A covariance of zeros, as in run.json, or of a pose that slam calls unknown, is none. A pose that is none, or a
/// state that this version does not know, makes the frame a lost one.
PublishedPose published_pose(const msg::TrackingResult& result);

/// The poses measured in the first map; those whose stamps do not increase are left out.
geometry::Trajectory measured_poses(const std::vector<PublishedPose>& published);

/// Normalised estimation error squared of a pose with 6 degrees of freedom, by the covariance that it came with (x y z
/// rx ry rz, m and rad, world frame): 6 in the mean if that is true. docs/theory/tracking.md Eq. (4).
inline double nees(const Eigen::Isometry3d& T_world_camera, const geometry::Matrix6d& covariance,
                   const Eigen::Isometry3d& T_world_camera_true) {
  const geometry::Vector6d error = geometry::pose_difference(T_world_camera_true, T_world_camera);
  return error.dot(covariance.ldlt().solve(error));
}

inline constexpr std::size_t kTrackingStates =
    static_cast<std::size_t>(msg::last_value(msg::TypeOf<msg::TrackingState>{})) + 1;

/// What counts as an error: docs/integrity.md.
struct IntegrityLimits {
  double span_s = 1;          ///< the error is that of the motion since so long ago
  double max_error_m = 0.05;  ///< beyond it, or beyond the next, state `ok` is dangerous
  double max_error_rad = 3 / kRadToDeg;
  double good_error_m = 0.01;  ///< below it, doubt is needless
};

/// How the covariance follows in one state: the mean trace of each time in that state, against that of the last frame
/// in state `ok` before it.
struct CovarianceGrowth {
  std::size_t spans = 0, grown = 0;
  double median_ratio = std::numeric_limits<double>::quiet_NaN();
};

/// How far the state and the covariance of published poses can be trusted. NaN where nothing could be measured.
struct Integrity {
  std::size_t frames = 0;  ///< all, with or without a pose
  std::array<std::size_t, kTrackingStates> in_state{};
  std::size_t judged = 0;     ///< whose error is known
  std::size_t dangerous = 0;  ///< `ok`, and the error exceeds a limit
  std::size_t returning = 0;  ///< of them: since a pose that was not `ok` itself, as when it returns to the right place
  std::size_t good = 0;       ///< error below IntegrityLimits::good_error_m, from the first `ok` on
  std::size_t needless = 0;   ///< of them: `doubtful`
  std::size_t episodes = 0;   ///< times in which the error exceeds a limit
  std::size_t unnoticed = 0;  ///< of them: `ok` to their end
  /// From the begin of an episode to the first frame that is not `ok`; to its end where it is unnoticed.
  double delay_s_max = std::numeric_limits<double>::quiet_NaN();
  double delay_s_median = std::numeric_limits<double>::quiet_NaN();
  std::size_t nees_frames = 0;  ///< frames `ok` with a covariance, without the first five poses
  double nees_ok = std::numeric_limits<double>::quiet_NaN();         ///< mean; 6 where the covariance is right
  double nees_ok_median = std::numeric_limits<double>::quiet_NaN();  ///< 5.3 where the covariance is right
  CovarianceGrowth doubtful, predicted;

  double dangerous_share() const;       ///< of all frames
  double needless_doubt_share() const;  ///< of the good frames
};

/// Judges the poses as they were published, in the order of their stamps.
Integrity judge_integrity(const std::vector<PublishedPose>& published, const Trajectory& groundtruth,
                          const IntegrityLimits& limits = {});

/// The error of a motion that begins with the pose of frame `since`.
struct SpanError : StepError {
  std::size_t since = 0;
};

/// The error of each frame's motion over the last span: since the newest pose of the same map that is at least that
/// old, else since the oldest one; none without a pose, ground truth or an earlier pose.
std::vector<std::optional<SpanError>> errors_over_span(const std::vector<PublishedPose>& published,
                                                       const Trajectory& groundtruth, double span_s);

/// Keys: docs/evaluation.md. Metres, degrees, seconds; unknown values are null when printed.
nlohmann::ordered_json to_json(const Drift& drift);
nlohmann::ordered_json to_json(const Integrity& integrity);

/// A figure for people: what it is of, and its value with unit.
using NamedFigure = std::pair<std::string, std::string>;
/// Drift in metres, degrees and their quotient, with what a nearly constant one means.
std::vector<NamedFigure> drift_figures(const Drift& drift, const std::optional<double>& scene_depth_m);
std::vector<NamedFigure> integrity_figures(const Integrity& integrity);

}  // namespace rtd::eval
