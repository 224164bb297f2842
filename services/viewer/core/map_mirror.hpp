// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <vector>

#include "common/msg/map_update.hpp"
#include "services/viewer/core/change_log.hpp"

namespace rtd::viewer {

/// A keyframe with the landmarks that are anchored to it.
struct MirroredKeyframe {
  std::uint32_t map_id = 0;
  bool removed = false;
  Eigen::Isometry3f T_world_camera = Eigen::Isometry3f::Identity();
  std::vector<Eigen::Vector3f> points_m;  ///< in its camera frame
  std::vector<std::uint32_t> covisible;
};

/// A camera position, in the frame of the keyframe before it, so that it moves along when a loop is closed.
struct TrajectoryPoint {
  std::uint32_t keyframe = kNone;
  Eigen::Vector3f position_m;
  static constexpr std::uint32_t kNone = UINT32_MAX;  ///< in the world frame
};

/// The map of one robot as slam publishes it, and what has changed since any revision. Memory is bounded: what does not
/// fit into the limits is left out and counted. One thread.
class MapMirror {
 public:
  struct Limits {
    std::size_t keyframes = 50'000, points = 2'000'000, edges = 1'000'000, trajectory = 4'000'000;
  };

  MapMirror() : MapMirror(Limits{}) {}
  explicit MapMirror(const Limits& limits) : limits_(limits) {}

  /// Counts the maps: another number means that everything before is void.
  std::uint64_t epoch() const { return epoch_; }

  /// Throws nothing: what does not fit is left out.
  void add(const msg::MapUpdate& update);
  /// Only the pose, or that it is gone.
  void add(const msg::KeyframeEvent& event);
  /// A measured camera position in the world frame of `map_id`. Positions in maps other than the first are left out.
  void add_position(std::uint32_t map_id, const Eigen::Vector3d& position_m);
  /// Forgets everything.
  void reset();

  const std::map<std::uint32_t, MirroredKeyframe>& keyframes() const { return keyframes_; }
  const MirroredKeyframe& keyframe(std::uint32_t id) const { return keyframes_.at(id); }
  const ChangeLog<std::uint32_t>& poses() const { return poses_; }
  const ChangeLog<std::uint32_t>& points() const { return points_; }
  const ChangeLog<std::uint32_t>& edges() const { return edges_; }
  const std::vector<std::uint32_t>& loop_edges() const { return loop_edges_; }  ///< pairs of keyframes
  std::uint64_t loop_revision() const { return loop_revision_; }
  const std::vector<TrajectoryPoint>& trajectory() const { return trajectory_; }
  std::size_t point_count() const { return point_count_; }
  /// Keyframes, points, edges and positions for which there was no room.
  std::uint64_t left_out() const { return left_out_; }

 private:
  /// What belongs to a keyframe's pose: nothing moves less than a viewer can show.
  bool move(std::uint32_t id, std::uint32_t map_id, const msg::Transform& T_world_camera);
  void remove(std::uint32_t id);
  void set_points(MirroredKeyframe& keyframe, const std::vector<float>& points_m);
  void set_edges(MirroredKeyframe& keyframe, const std::vector<std::uint32_t>& covisible);

  Limits limits_;
  std::map<std::uint32_t, MirroredKeyframe> keyframes_;
  ChangeLog<std::uint32_t> poses_, points_, edges_;
  std::vector<std::uint32_t> loop_edges_;
  std::vector<TrajectoryPoint> trajectory_;
  std::uint64_t epoch_ = 1, loop_revision_ = 0, next_event_ = 0;
  std::int64_t session_ns_ = 0;
  std::size_t point_count_ = 0, edge_count_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace rtd::viewer
