// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/trajectory.hpp"

namespace rtd::geometry {

/// A trajectory as others write it, and what was left out or understood on the way: one line for people each.
struct PoseList {
  Trajectory poses;                ///< stamps strictly increasing
  std::vector<std::string> notes;  ///< nothing is lost: a title, rows of nan, another unit of the stamps, another order
  std::vector<std::string> damages;  ///< rows that cannot be read
  std::size_t places = 0;  ///< not 0: there are no stamps, those of the poses count from 0; lost rows have a place too
};

/// Reads poses of a text, with or without byte order mark, separated by blanks, commas or semicolons, '#' for comments:
/// - TUM's: stamp tx ty tz qx qy qz qw, or stamp and the upper 3 x 4 (or all 4 x 4) of T_world_body. The stamp is in s,
///   ms, us or ns, by its size and steps, or the name of an image that begins with it ("rgb/12.5.png"); of a list of
///   associations with ground truth ("stamp rgb stamp depth stamp tx ..."), the last one counts.
/// - EuRoC's csv: columns by the names in its title (p_x or p_RS_R_x [m], q_w, ...), or a stamp in ns before commas,
/// then
///   tx, ty, tz, qw, qx, qy, qz; others are ignored.
/// - Without stamps: KITTI's 12 or 16 numbers of a matrix, TartanAir's tx ty tz qx qy qz qw, or matrices in four rows,
///   with or without a row of three numbers before each (Redwood, Open3D).
/// A title and rows of nan are left out. Where stamps go back the file has several segments: the longest is taken,
/// unless no order is there, then all by their stamps. Throws TrajectoryError, which names file, line and cause: no
/// poses, or at least as many rows that cannot be read.
PoseList read_pose_list(const std::string& text, const std::string& name);
/// Of a file.
PoseList read_pose_list(const std::filesystem::path& path);

/// Gives the poses of a list without stamps those of each place; false when there are not as many.
bool give_stamps(PoseList& list, const std::vector<std::int64_t>& stamps_ns);

/// The pose of the upper 3 x 4 of its matrix; empty where its left part is no rotation matrix (to 0.01).
std::optional<Eigen::Isometry3d> matrix_pose(const Eigen::Matrix<double, 3, 4>& rows);

/// The number that a name of an image file is, as "12.5" of "rgb/12.5.png"; the text itself where it is a number.
std::string stamp_in_name(const std::string& text);

}  // namespace rtd::geometry
