// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/map/trajectory.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include "common/geometry/ply.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kLineLength = 256;
constexpr double kUnknownDepth_per_m = 0.02;  ///< of the inverse: a metre at 7 m

/// Of a hand or a robot with a camera, and of poses: m and rad alike.
constexpr double kSigmaAcceleration = 2;
constexpr double kSigmaDoubtful = 0.02;
constexpr double kSigmaTrusted = 0.003;
constexpr std::size_t kTrustedAround = 3;  ///< poses on each side
constexpr double kMaxGap_s = 0.5;          ///< a motion is not known across a longer one

/// What is added to the poses: way and turn in the world, a row each.
using Corrections = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// Accelerations are linear in the corrections: change * corrections + measured, by kSigmaAcceleration.
struct Accelerations {
  Eigen::SparseMatrix<double> change;
  Corrections measured;
};

Accelerations accelerations_of(std::span<const StampedPose> poses) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  Accelerations result{Eigen::SparseMatrix<double>(count - 2, count), Corrections(count - 2, 6)};
  const auto velocity = [&](std::size_t i, double duration_s) -> geometry::Vector6d {
    return geometry::pose_difference(poses[i].T_world_body, poses[i + 1].T_world_body) / duration_s;
  };
  for (Eigen::Index row = 0; row < count - 2; ++row) {
    const auto i = static_cast<std::size_t>(row);
    const double before_s = msg::minus_s(poses[i + 1].stamp_ns, poses[i].stamp_ns);
    const double after_s = msg::minus_s(poses[i + 2].stamp_ns, poses[i + 1].stamp_ns);
    const double scale = 2 / ((before_s + after_s) * kSigmaAcceleration);
    result.change.insert(row, row) = scale / before_s;
    result.change.insert(row, row + 1) = -scale / before_s - scale / after_s;
    result.change.insert(row, row + 2) = scale / after_s;
    result.measured.row(row) = scale * (velocity(i + 1, after_s) - velocity(i, before_s)).transpose();
  }
  return result;
}

/// Least squares with robust (Cauchy) weights of the doubtful poses: some follow a person, others are right.
Corrections smooth(const Accelerations& accelerations, const std::vector<bool>& doubtful, std::size_t from) {
  constexpr int kIterations = 8;
  const Eigen::Index count = accelerations.change.cols();
  const Eigen::SparseMatrix<double> of_change = accelerations.change.transpose() * accelerations.change;
  const Corrections target = -(accelerations.change.transpose() * accelerations.measured);
  Corrections corrections = Corrections::Zero(count, 6);
  Eigen::SparseMatrix<double> of_poses(count, count);
  of_poses.setIdentity();
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const bool in_doubt = doubtful[from + static_cast<std::size_t>(i)];
      const double sigma2 = in_doubt ? kSigmaDoubtful * kSigmaDoubtful : kSigmaTrusted * kSigmaTrusted;
      of_poses.coeffRef(i, i) = 1 / (sigma2 + (in_doubt ? corrections.row(i).squaredNorm() : 0));
    }
    solver.compute(of_change + of_poses);
    corrections = solver.solve(target);
  }
  return corrections;
}

bool is_without_gap(std::span<const StampedPose> poses) {
  return std::adjacent_find(poses.begin(), poses.end(), [](const StampedPose& one, const StampedPose& next) {
           const double gap_s = msg::minus_s(next.stamp_ns, one.stamp_ns);
           return gap_s <= 0 || gap_s > kMaxGap_s;
         }) == poses.end();
}

/// `doubtful[from + i]` belongs to poses[i].
void mend(std::span<StampedPose> poses, const std::vector<bool>& doubtful, std::size_t from) {
  const Corrections corrections = smooth(accelerations_of(poses), doubtful, from);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!doubtful[from + i]) continue;
    const geometry::Vector6d correction = corrections.row(static_cast<Eigen::Index>(i)).transpose();
    Eigen::Isometry3d& T_world_camera = poses[i].T_world_body;
    T_world_camera.translation() += correction.head<3>();
    T_world_camera.linear() = geometry::so3_exp(correction.tail<3>()) * T_world_camera.linear();
  }
}

}  // namespace

void thin_out(std::vector<FrameRecord>& frames, std::size_t limit) {
  if (frames.size() < limit) return;
  const std::size_t half = frames.size() / 2;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i >= half || i % 2 == 0) frames[kept++] = frames[i];
  }
  frames.resize(kept);
}

FrameRecord* find_frame(std::vector<FrameRecord>& frames, std::uint64_t seq) {
  const auto frame =
      std::find_if(frames.rbegin(), frames.rend(), [seq](const FrameRecord& record) { return record.seq == seq; });
  return frame == frames.rend() ? nullptr : &*frame;
}

void correct_frames(std::span<const PoseCorrection> corrections, std::vector<FrameRecord>& frames) {
  for (const auto& [seq, T_claimed_smoothed] : corrections) {
    FrameRecord* const frame = find_frame(frames, seq);
    if (frame != nullptr) frame->T_reference_camera = frame->T_reference_camera * T_claimed_smoothed;
  }
}

void tie_to_living(std::vector<FrameRecord>& frames, const Map& map) {
  for (FrameRecord& frame : frames) {
    if (map.find_keyframe(frame.reference) != nullptr) continue;
    const auto [ancestor, T_ancestor_reference] = map.living_ancestor(frame.reference);
    frame.T_reference_camera = T_ancestor_reference * frame.T_reference_camera;
    frame.reference = ancestor;
  }
}

void mend_doubtful(std::vector<StampedPose>& poses, const std::vector<bool>& doubtful) {
  std::size_t begin = 0;
  while (begin < poses.size()) {
    if (!doubtful[begin]) {
      ++begin;
      continue;
    }
    std::size_t end = begin, trusted = 0;
    for (; end < poses.size() && trusted < kTrustedAround; ++end) trusted = doubtful[end] ? 0 : trusted + 1;
    const std::size_t from = begin - std::min(begin, kTrustedAround);
    const std::span<StampedPose> stretch = std::span(poses).subspan(from, end - from);
    if (from < begin && trusted > 0 && is_without_gap(stretch)) mend(stretch, doubtful, from);
    begin = end;
  }
}

std::vector<StampedPose> compose_trajectory(const Map& map, const std::vector<FrameRecord>& frames, MapId id) {
  std::vector<StampedPose> poses;
  std::vector<bool> doubtful;
  poses.reserve(frames.size());
  for (const FrameRecord& frame : frames) {
    if (map.map_of(frame.reference) != id) continue;
    poses.push_back({frame.stamp_ns, map.T_world_keyframe(frame.reference) * frame.T_reference_camera});
    doubtful.push_back(frame.doubtful);
  }
  mend_doubtful(poses, doubtful);
  return poses;
}

std::vector<StampedPose> keyframe_trajectory(const Map& map, MapId id) {
  std::vector<StampedPose> poses;
  for (const auto& [keyframe_id, keyframe] : map.keyframes()) {
    if (keyframe.map == id) poses.push_back({keyframe.frame->stamp_ns, keyframe.T_world_camera});
  }
  return poses;
}

std::vector<MapPoint> map_points(const Map& map, MapId id) {
  std::vector<MapPoint> points;
  points.reserve(map.landmark_count());
  append_map_points(map, id, map.landmark_ids(), points);
  return points;
}

void append_map_points(const Map& map, MapId id, std::span<const LandmarkId> landmarks, std::vector<MapPoint>& points) {
  for (const LandmarkId landmark_id : landmarks) {
    const Landmark* landmark = map.find_landmark(landmark_id);
    if (landmark == nullptr || map.map_of(landmark->reference) != id) continue;
    if (unmeasured_depth(map, *landmark).sigma_per_m > kUnknownDepth_per_m) continue;
    points.push_back({landmark->position.cast<float>(), static_cast<float>(landmark->static_probability)});
  }
}

void write_ply(std::ostream& out, const std::vector<MapPoint>& points) {
  geometry::write_ply_header(out, geometry::PlyFormat::kAscii, "RTD-SLAM landmarks, world frame, metres", points.size(),
                             {{"float", "x"}, {"float", "y"}, {"float", "z"}, {"float", "static_probability"}});
  std::array<char, kLineLength> line{};
  for (const MapPoint& point : points) {
    std::snprintf(line.data(), line.size(), "%.5f %.5f %.5f %.3f\n", static_cast<double>(point.position.x()),
                  static_cast<double>(point.position.y()), static_cast<double>(point.position.z()),
                  static_cast<double>(point.static_probability));
    out << line.data();
  }
}

}  // namespace rtd::slam
