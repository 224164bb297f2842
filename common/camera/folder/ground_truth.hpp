// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/camera/folder/layouts.hpp"
#include "common/geometry/trajectory.hpp"

namespace rtd::camera {

/// True poses of a folder's camera, with the stamps that its frames have before a rate is applied. T_world_camera,
/// optical frame.
struct GroundTruth {
  geometry::Trajectory poses;
  std::string note;                  ///< what was read, for people; empty: there is none
  std::vector<std::string> remarks;  ///< what was left out, or why it is not used
};

/// Reads one file for each frame (4 x 4 or 3 x 4 matrices), or a table: all that read_pose_list() reads. Rows without
/// stamps belong to the images in order. `y_up`: the poses are those of a camera whose y axis points up, in a
/// left-handed world (ICL-NUIM). Never throws for what a file says: SLAM needs no ground truth.
GroundTruth read_ground_truth(const FolderContents& contents, const PairList& list, bool y_up);

/// Poses for frames that got other stamps: for each frame the pose that it had at its old stamp.
geometry::Trajectory retimed(const geometry::Trajectory& poses, const std::vector<std::int64_t>& old_ns,
                             const std::vector<std::int64_t>& new_ns, std::int64_t max_gap_ns);

}  // namespace rtd::camera
