// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtd::geometry {

/// Where a body (a camera, a marker frame) was in a world at a time.
struct StampedPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
};

/// Poses in increasing order of stamps, unless said otherwise.
using Trajectory = std::vector<StampedPose>;

/// The stamps of a trajectory, or of other things with a stamp_ns, in order.
std::vector<std::int64_t> stamps_of(const auto& stamped) {
  std::vector<std::int64_t> stamps_ns;
  stamps_ns.reserve(stamped.size());
  for (const auto& one : stamped) stamps_ns.push_back(one.stamp_ns);
  return stamps_ns;
}

/// Indices of two stamps that belong to the same moment.
struct StampPair {
  std::size_t first = 0, second = 0;
};

/// Pairs stamps as TUM's associate.py does: all candidates closer than max_difference_ns, taken greedily by smallest
/// difference (ties: earlier first, then earlier second), each stamp used once. Both inputs in increasing order. The
/// result is in order of the first stamps.
std::vector<StampPair> associate(const std::vector<std::int64_t>& first_ns, const std::vector<std::int64_t>& second_ns,
                                 std::int64_t max_difference_ns);

/// The pose at a stamp between two of a trajectory in increasing order: the motion between them is taken to be even.
/// Empty unless both, or one of that very stamp, are within `max_gap_ns`.
std::optional<Eigen::Isometry3d> pose_at(const Trajectory& trajectory, std::int64_t stamp_ns, std::int64_t max_gap_ns);

/// A trajectory or frame list cannot be used; what() names file, line, cause and fix.
class TrajectoryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A pose of what a file says. Throws std::invalid_argument: a value that is not finite, a quaternion more than 5 % too
/// long or short (else it is normalised).
Eigen::Isometry3d make_pose(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation);

/// Of poses with one stamp, the last stays.
Trajectory each_stamp_once(const Trajectory& ordered);

/// The parts in which stamps never go back, in their order: a recording that is played twice gives two. At least one.
std::vector<Trajectory> split_where_time_goes_back(const Trajectory& poses);

/// The text of a file with poses; /dev/stdin and the shell's <(...) may be pipes. Throws TrajectoryError.
std::string read_poses_text(const std::filesystem::path& path);

/// Reads the stamps (first column) of a frame list such as rgb.txt or associations.txt; of a list of names only
/// ("rgb/12.5.png") they are in the names. Throws TrajectoryError.
std::vector<std::int64_t> read_frame_stamps(const std::filesystem::path& path);

/// How a trajectory is written: "%.6f" for stamps, "%.9f" for values in both.
enum class TumStyle {
  kEstimate,    ///< stamps rounded to microseconds, qw >= 0
  kGroundtruth  ///< with a title; stamps cut to microseconds, as in the names of a TUM folder's images
};

/// Writes TUM's format, one "stamp tx ty tz qx qy qz qw" per line.
void write_tum_trajectory(std::ostream& out, const Trajectory& trajectory, TumStyle style = TumStyle::kEstimate);

/// Seconds with six decimals, the rest cut off: a stamp as TUM folders name their images. `stamp_ns` >= 0.
std::string tum_stamp(std::int64_t stamp_ns);

}  // namespace rtd::geometry
