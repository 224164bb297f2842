// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/geometry/trajectory.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::recordings {
class Reader;
}

namespace rtd::eval {

/// The rate of KITTI's sequences.
inline constexpr double kNumberedHz = 10;

/// The stamps of files that have none (KITTI). At most one of the two; with neither, poses count by their number.
struct MissingStamps {
  double rate_hz = 0;      ///< pose i is of i / rate; 0: not given
  std::string times_file;  ///< stamps in seconds, one a line; empty: not given
};

/// A trajectory of a file.
struct PoseFile {
  geometry::Trajectory poses;
  bool took_stamps = false;              ///< from MissingStamps
  std::vector<std::string> damages;      ///< what was lost, one line each
  std::vector<PublishedPose> published;  ///< with states and covariances; only of results of slam (rtd/tracking)
  std::vector<std::string> notes = {};   ///< what was understood or left out without a loss, one line each
  bool numbered = false;                 ///< there are no stamps: pose i is at i / kNumberedHz
};

/// Which poses of a recording are meant; empty: the only ones there are.
struct PoseChoice {
  std::string topic;
  std::string child;  ///< of a topic of transforms: the frame whose poses they are
};

/// Reads the results of slam (rtd/tracking), where that topic is chosen, else geometry_msgs PoseStamped,
/// PoseWithCovarianceStamped and TransformStamped, nav_msgs Odometry, and tf, by the stamps of their headers. Without a
/// choice it takes the only topic of poses; when there is none, the only child frame of tf. /tf_static is left out.
/// Throws geometry::TrajectoryError: nothing fits, or several do (it lists them), a pose that is none, or a frame with
/// several parents.
PoseFile read_recorded_poses(recordings::Reader& recording, const PoseChoice& choice);

/// Reads a trajectory in TUM's, KITTI's or EuRoC's format or from a recording (ROS 1 bag, MCAP, .db3),
/// which it distinguishes by their content. `argument` is FILE, and for a recording FILE?topic=/x&child=FRAME. Throws
/// geometry::TrajectoryError or mcap::RecordingFileError, which name the file, the line or topic and what is expected.
PoseFile read_pose_file(const std::string& argument, const MissingStamps& stamps);

}  // namespace rtd::eval
