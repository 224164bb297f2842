// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtd::eval {

/// One row of a trajectory: where the body (camera or marker frame) was in its world at a time.
struct StampedPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
};

/// Poses in strictly increasing order of stamps.
using Trajectory = std::vector<StampedPose>;

/// A trajectory or frame list cannot be used; what() names file, line, cause and fix.
class TrajectoryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads TUM's format, one pose per line: `stamp_s tx ty tz qx qy qz qw`, separated by blanks or commas.
/// Blank lines and lines that start with `#` are skipped. Quaternions within 1 % of unit length are normalised. A
/// repeated stamp replaces the row before it, as in TUM's tools (some of TUM's own ground truths need this). Throws
/// TrajectoryError: no file, no poses, wrong number of columns, not a finite number, non-unit quaternion, stamps that
/// go backwards.
Trajectory read_tum_trajectory(const std::filesystem::path& path);

/// As above from a stream; `name` stands for the file in messages.
Trajectory read_tum_trajectory(std::istream& input, const std::string& name);

/// Reads the stamps (first column) of a frame list such as rgb.txt or associations.txt. Throws TrajectoryError.
std::vector<std::int64_t> read_frame_stamps(const std::filesystem::path& path);

/// Decimal seconds -> nanoseconds, exact for plain decimals with up to nine places. Throws std::invalid_argument with
/// the cause.
std::int64_t parse_stamp_ns(const std::string& text);

/// The stamps of a trajectory, in order.
std::vector<std::int64_t> stamps_of(const Trajectory& trajectory);

}  // namespace rtd::eval
