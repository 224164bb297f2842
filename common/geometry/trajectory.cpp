// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <queue>
#include <tuple>

#include "common/geometry/pose_list.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/io/text.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::geometry {
namespace {

constexpr double kMaxQuaternionError = 0.05;  // of the length; TUM's own ground truth comes near it

[[noreturn]] void fail(const std::string& name, int line, const std::string& cause) {
  throw TrajectoryError(name + ":" + std::to_string(line) + ": " + cause);
}

std::vector<io::TextLine> lines_of(std::string_view text) {
  return io::split_lines(text, " \t\r,;");
}

/// Stamps of both sides in one line by their time. The pair that is closest of all stands side by side in it; when it
/// has left the line, its neighbours stand side by side.
class Association {
 public:
  Association(const std::vector<std::int64_t>& first_ns, const std::vector<std::int64_t>& second_ns,
              std::int64_t max_difference_ns)
      : max_difference_ns_(max_difference_ns) {
    for (std::size_t i = 0; i < first_ns.size(); ++i) line_.push_back({first_ns[i], 0, i});
    for (std::size_t i = 0; i < second_ns.size(); ++i) line_.push_back({second_ns[i], 1, i});
    std::ranges::sort(line_, {},
                      [](const Place& place) { return std::tuple(place.stamp_ns, place.side, place.index); });
    for (std::size_t i = 0; i < line_.size(); ++i) {
      line_[i].before = i == 0 ? kNone : i - 1;
      line_[i].after = i + 1 == line_.size() ? kNone : i + 1;
      add_candidate(line_[i].before, i);
    }
  }

  std::vector<StampPair> run() {
    std::vector<StampPair> pairs;
    for (; !candidates_.empty(); candidates_.pop()) {
      const Candidate next = candidates_.top();
      if (line_[next.left].paired || line_[next.right].paired) continue;
      line_[next.left].paired = line_[next.right].paired = true;
      pairs.push_back({next.first, next.second});
      const std::size_t before = line_[next.left].before, after = line_[next.right].after;
      if (before != kNone) line_[before].after = after;
      if (after != kNone) line_[after].before = before;
      add_candidate(before, after);
    }
    std::ranges::sort(pairs, {}, &StampPair::first);
    return pairs;
  }

 private:
  static constexpr std::size_t kNone = SIZE_MAX;
  struct Place {
    std::int64_t stamp_ns;
    int side;  ///< 0: the first stamps
    std::size_t index;
    std::size_t before = kNone, after = kNone;  ///< places in the line
    bool paired = false;
  };
  struct Candidate {
    std::int64_t difference_ns;
    std::size_t first, second;  ///< indices of the stamps
    std::size_t left, right;    ///< places in the line
    bool operator>(const Candidate& other) const {
      return std::tie(difference_ns, first, second) > std::tie(other.difference_ns, other.first, other.second);
    }
  };

  void add_candidate(std::size_t left, std::size_t right) {
    if (left == kNone || right == kNone || line_[left].side == line_[right].side) return;
    const std::int64_t difference_ns = msg::apart_ns(line_[left].stamp_ns, line_[right].stamp_ns);
    if (difference_ns >= max_difference_ns_) return;
    const auto& [first, second] = line_[left].side == 0 ? std::pair(left, right) : std::pair(right, left);
    candidates_.push({difference_ns, line_[first].index, line_[second].index, left, right});
  }

  const std::int64_t max_difference_ns_;
  std::vector<Place> line_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates_;
};

/// Rounded to microseconds. From the integer: a double would lose the last digits of today's stamps.
std::string rounded_stamp(std::int64_t stamp_ns) {
  const bool negative = stamp_ns <= -500;
  return (negative ? "-" : "") + tum_stamp(msg::plus_ns(msg::apart_ns(stamp_ns, 0), 500));
}

}  // namespace

Eigen::Isometry3d make_pose(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation) {
  if (!translation.allFinite() || !rotation.coeffs().allFinite()) {
    throw std::invalid_argument("the pose has a value that is not finite");
  }
  if (std::abs(rotation.norm() - 1) > kMaxQuaternionError) {
    throw std::invalid_argument("quaternion has length " + std::to_string(rotation.norm()) + " instead of 1");
  }
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  T_world_body.linear() = rotation.normalized().toRotationMatrix();
  T_world_body.translation() = translation;
  return T_world_body;
}

Trajectory each_stamp_once(const Trajectory& ordered) {
  Trajectory trajectory;
  for (const StampedPose& pose : ordered) {
    if (!trajectory.empty() && trajectory.back().stamp_ns == pose.stamp_ns) trajectory.pop_back();
    trajectory.push_back(pose);
  }
  return trajectory;
}

std::vector<Trajectory> split_where_time_goes_back(const Trajectory& poses) {
  std::vector<Trajectory> segments(1);
  for (const StampedPose& pose : poses) {
    if (!segments.back().empty() && pose.stamp_ns < segments.back().back().stamp_ns) segments.emplace_back();
    segments.back().push_back(pose);
  }
  return segments;
}

std::optional<Eigen::Isometry3d> pose_at(const Trajectory& trajectory, std::int64_t stamp_ns, std::int64_t max_gap_ns) {
  const auto after = std::ranges::lower_bound(trajectory, stamp_ns, {}, &StampedPose::stamp_ns);
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return after->T_world_body;
  if (after == trajectory.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(after);
  if (msg::minus_ns(stamp_ns, before.stamp_ns) > max_gap_ns || msg::minus_ns(after->stamp_ns, stamp_ns) > max_gap_ns)
    return std::nullopt;
  const double share = static_cast<double>(msg::minus_ns(stamp_ns, before.stamp_ns)) /
                       static_cast<double>(msg::minus_ns(after->stamp_ns, before.stamp_ns));
  const Eigen::Isometry3d& a = before.T_world_body;
  const Eigen::Isometry3d& b = after->T_world_body;
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  T_world_body.linear() =
      Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear())).toRotationMatrix();
  T_world_body.translation() = (1 - share) * a.translation() + share * b.translation();
  return T_world_body;
}

std::vector<StampPair> associate(const std::vector<std::int64_t>& first_ns, const std::vector<std::int64_t>& second_ns,
                                 std::int64_t max_difference_ns) {
  return Association(first_ns, second_ns, max_difference_ns).run();
}

std::string read_poses_text(const std::filesystem::path& path) {
  try {
    return io::read_file(path, io::kPoses);
  } catch (const io::IoError& error) {
    throw TrajectoryError(error.what());
  }
}

std::vector<std::int64_t> read_frame_stamps(const std::filesystem::path& path) {
  std::vector<std::int64_t> stamps_ns;
  for (const io::TextLine& line : lines_of(read_poses_text(path))) {
    try {
      stamps_ns.push_back(io::parse_stamp_ns(stamp_in_name(line.fields[0])));
    } catch (const std::invalid_argument& error) {
      fail(path.string(), line.number, error.what());
    }
  }
  if (stamps_ns.empty()) throw TrajectoryError(path.string() + ": holds no frames");
  return stamps_ns;
}

void write_tum_trajectory(std::ostream& out, const Trajectory& trajectory, TumStyle style) {
  const bool estimate = style == TumStyle::kEstimate;
  if (!estimate) out << "# timestamp tx ty tz qx qy qz qw\n";
  std::array<char, 256> values{};
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.T_world_body.translation();
    Eigen::Quaterniond q(pose.T_world_body.linear());
    if (estimate) q.normalize();
    if (estimate && q.w() < 0) q.coeffs() = -q.coeffs();
    std::snprintf(values.data(), values.size(), " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", t.x(), t.y(), t.z(), q.x(),
                  q.y(), q.z(), q.w());
    out << (estimate ? rounded_stamp(pose.stamp_ns) : tum_stamp(pose.stamp_ns)) << values.data();
  }
}

std::string tum_stamp(std::int64_t stamp_ns) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%lld.%06lld", static_cast<long long>(stamp_ns / 1'000'000'000),
                static_cast<long long>(stamp_ns % 1'000'000'000 / 1000));
  return text.data();
}

}  // namespace rtd::geometry
