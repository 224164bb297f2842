// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/trajectory.hpp"

namespace rtd::eval {

/// The formats of trajectories in text.
enum class PoseFormat { kTum, kKitti, kEuroc };

/// By the first lines: EuRoC's title "#timestamp [ns],..." or stamps in nanoseconds before commas; KITTI's 12 numbers a
/// line; TUM's format for everything else.
PoseFormat format_of(const std::string& text);

/// KITTI's odometry format: the upper 3 x 4 of T_world_camera, row by row, without stamp; pose i is of `stamps_ns`[i].
/// Throws geometry::TrajectoryError, which names `name` and the line: another number of columns, no rotation, another
/// number of poses than stamps, no pose.
geometry::Trajectory read_kitti(const std::string& text, const std::string& name,
                                const std::vector<std::int64_t>& stamps_ns);

/// The number of poses in such a text.
std::size_t count_kitti(const std::string& text);

/// EuRoC's csv: stamps in nanoseconds, columns by the names in the title (p_x or p_RS_R_x [m], q_w, ...; others are
/// ignored), without title: time, p_x, p_y, p_z, q_w, q_x, q_y, q_z. Throws geometry::TrajectoryError.
geometry::Trajectory read_euroc(const std::string& text, const std::string& name);

}  // namespace rtd::eval
