// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "services/slam/core/map/trajectory.hpp"

namespace rtd::map_tool {

/// The landmarks of one map of a file, by id.
std::vector<slam::MapPoint> points_of(const slam::MapContents& contents, slam::MapId map);
/// The poses of its keyframes, by time.
std::vector<slam::StampedPose> poses_of(const slam::MapContents& contents, slam::MapId map);

/// ASCII PCD 0.7: x y z static_probability, as the Point Cloud Library reads it.
void write_pcd(std::ostream& out, const std::vector<slam::MapPoint>& points);

}  // namespace rtd::map_tool
