// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/trajectory/integrity.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {

/// Where the camera is in the body whose poses the ground truth has, when they are two: the markers of a motion capture
/// have their own axes.
struct BodyOffset {
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  bool of_bonn = false;  ///< the turn is that of the Bonn RGB-D Dynamic Dataset
};

/// The constant transform X with A X = X B for the motions A of the body and B of the camera over a second (hand-eye
/// calibration; docs/evaluation.md Eq. (11)). Empty unless it is plainly there: the body turns about more than one
/// axis, X turns by more than 2 degrees or moves by more than 2 cm, and the median error of these motions in rotation
/// or in translation falls below half with it. `scale` multiplies the estimate's translations.
std::optional<BodyOffset> find_body_offset(const Trajectory& estimate, const Trajectory& groundtruth, double offset_s,
                                           double scale = 1);

/// Ground truth of the camera; as it is where there is no offset.
Trajectory camera_truth(const Trajectory& groundtruth, const std::optional<BodyOffset>& offset);

/// "the ground truth is of another body: the camera is turned by 127.3 degrees and 0.019 m away from it ...".
std::string explain(const BodyOffset& offset);

/// A time without poses.
struct LostSpan {
  std::int64_t first_ns = 0;  ///< frame list: first frame without pose; ground truth: last pose before the gap
  std::int64_t last_ns = 0;   ///< frame list: last frame without pose; ground truth: first pose after the gap
  std::size_t frames = 0;     ///< frames without pose; 0 when no frame list is known
};

/// How much of a sequence has poses.
struct Coverage {
  double fraction = 0;     ///< [0, 1]
  std::size_t frames = 0;  ///< length of the frame list; 0 when measured against the ground truth's span
  std::size_t tracked = 0;
  std::vector<LostSpan> lost;
};

/// Frames with a pose over all frames; a frame has a pose when one lies within 1 ms. Stamps in increasing order.
Coverage coverage_of_frames(const std::vector<std::int64_t>& frames_ns, const std::vector<std::int64_t>& poses_ns);

/// Time covered over the time from `first_ns` to `last_ns` (the ground truth's span): neighbouring poses, and the two
/// ends, cover what lies between them unless they are further apart than max_gap_s. Stamps in increasing order.
Coverage coverage_of_span(std::int64_t first_ns, std::int64_t last_ns, const std::vector<std::int64_t>& poses_ns,
                          double max_gap_s);

struct EvaluationOptions : AteOptions {
  double max_gap_s = 0.5;  ///< longer gaps between poses count as lost when there is no frame list
};

/// Fewer poses have no ATE: any two fit any other two.
inline constexpr std::size_t kFewestAtePoses = 3;

/// All errors of an estimate compared with its ground truth.
struct Evaluation {
  std::size_t estimate_poses = 0, groundtruth_poses = 0;
  AteResult ate;                     ///< of the positions as they are
  std::optional<BodyOffset> offset;  ///< taken into account in what follows
  RpeResult rpe_per_second, rpe_per_frame, rpe_per_metre;
  Drift drift;
  Coverage coverage;
};

/// ATE, RPE in the three units, drift and coverage. With a similarity alignment its scale also applies to RPE and
/// drift. `frames_ns`: stamps of all frames of the run, in order; without them coverage refers to the ground truth's
/// span.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& groundtruth, const EvaluationOptions& options = {},
                    const std::optional<std::vector<std::int64_t>>& frames_ns = std::nullopt);

/// Says so when one of the two seems to be in mm or cm: it fits when it is scaled, and not otherwise. Empty else.
std::optional<std::string> other_unit(const Trajectory& estimate, const Trajectory& groundtruth,
                                      const AteOptions& options = {});

/// {count, rmse, mean, median, std, min, max}, every error times `factor`; unknown values become null when printed.
nlohmann::ordered_json to_json(const Statistics& statistics, double factor = 1);

/// Machine-readable form of an evaluation; keys in docs/evaluation.md. Metres, degrees, seconds.
nlohmann::ordered_json to_json(const Evaluation& evaluation);

}  // namespace rtd::eval
