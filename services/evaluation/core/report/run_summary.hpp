// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/run_record/run_record.hpp"
#include "services/evaluation/core/removal/removal.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {

/// A run with the files of its folder and what is computed from its source.
struct Run : run_record::RunRecord {
  std::string trajectory_path;   ///< TUM format: final poses that slam wrote, else those published; empty = none
  std::string groundtruth_path;  ///< TUM format; empty = none
  std::string static_map_path;   ///< static_map.ply that dense wrote; empty = none
  std::uint64_t static_map_points = 0;
  std::vector<std::pair<std::string, std::string>> pages;  ///< that link to one another: names, and places from here
  std::vector<Eigen::Vector3d> landmarks_m;                ///< of map.ply, thinned; empty = none
  std::optional<RunRemoval> removal;                       ///< of sources that know what moves
};

/// Times in ms; NaN when nothing was measured.
struct TimeSummary {
  std::size_t count = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double p50 = std::numeric_limits<double>::quiet_NaN();
  double p99 = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

/// One stage of filter or slam, over the frames in which it ran.
struct StageSummary {
  std::string name;  ///< "filter.extract", "slam.pose", ...
  TimeSummary ms;
};

/// Consecutive frames without pose.
struct LostFrames {
  std::uint64_t first_seq = 0, last_seq = 0;
  double start_s = 0;  ///< since the first frame
  std::uint64_t frames() const { return last_seq - first_seq + 1; }
};

/// The numbers of a run, ready to be written. Doubles are NaN where unknown.
struct RunSummary {
  run_record::FrameUse frames;
  double coverage = std::numeric_limits<double>::quiet_NaN();  ///< frames with pose / frames that the source had
  double fps = std::numeric_limits<double>::quiet_NaN();       ///< frames in / duration of the run
  TimeSummary latency_ms;                                      ///< camera published -> pose ready
  std::vector<StageSummary> stages;
  std::vector<LostFrames> lost;
  double kept_mean = std::numeric_limits<double>::quiet_NaN();     ///< features offered to tracking, per frame
  double removed_mean = std::numeric_limits<double>::quiet_NaN();  ///< features judged dynamic, per frame
  std::uint32_t keyframes = 0, landmarks = 0;                      ///< at the end
  Trajectory estimate, groundtruth;             ///< final trajectory and ground truth; empty when there is none
  std::optional<Evaluation> final_trajectory;   ///< trajectory.txt against ground truth
  std::optional<Evaluation> online_trajectory;  ///< poses as they were published, frame by frame
  std::optional<Integrity> integrity;           ///< of the poses as they were published, with their states
  std::optional<double> scene_depth_m;          ///< only where the drift is nearly constant and the source still there
  std::vector<std::string> notes;               ///< what could not be computed, and why
};

/// Reads the trajectories of the run and computes everything. Never throws on bad data: bad data become a note.
RunSummary summarize_run(const Run& run);

/// The poses of the tracked frames as published, in order.
Trajectory online_trajectory(const Run& run);

/// Drift of the poses as published, else of the final ones; null without ground truth.
const Drift* drift_of(const RunSummary& summary);

/// Camera to pose, ms; nothing when the frame has no pose or was not timed.
std::optional<double> latency_ms(const run_record::FrameRecord& frame);

}  // namespace rtd::eval
