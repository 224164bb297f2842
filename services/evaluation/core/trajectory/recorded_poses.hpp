// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/trajectory.hpp"
#include "common/recordings/reader.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {

/// Which poses of a recording are meant; empty: the only ones there are.
struct PoseChoice {
  std::string topic;  ///< of a type in pose_types()
  std::string child;  ///< of a topic of transforms: the frame whose poses they are
};

/// The poses of a recording, by the stamps of their headers, and how they were chosen.
struct RecordedPoses {
  geometry::Trajectory poses;
  std::string topic, child;
  std::vector<std::string> damages;  ///< what could not be read, one line each
};

/// Reads geometry_msgs PoseStamped, PoseWithCovarianceStamped and TransformStamped, nav_msgs Odometry, and tf. Without
/// a choice it takes the only topic of poses; when there is none, the only child frame of tf. /tf_static is left out.
/// Throws geometry::TrajectoryError: nothing fits, or several do (it lists them), a pose that is none, or a frame with
/// several parents.
RecordedPoses read_recorded_poses(recordings::Reader& recording, const PoseChoice& choice);

/// The results of slam in a recording (topic rtd/tracking), one for each frame, in the order of their stamps.
struct RecordedResults {
  std::vector<PublishedPose> published;
  std::vector<std::string> damages;  ///< what could not be read, one line each
};

/// The topic that is chosen, if it has results of slam.
std::optional<std::string> topic_of_results(const recordings::Reader& recording, const PoseChoice& choice);

RecordedResults read_recorded_results(recordings::Reader& recording, const std::string& topic);

}  // namespace rtd::eval
