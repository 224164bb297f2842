// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "common/msg/map_update.hpp"
#include "common/msg/tracking.hpp"

namespace rtd::viewer {

/// Keys in the order of their last change. Any number of followers each keep the revision up to which they know all,
/// and continue from there; a key that changed several times meanwhile comes once.
template <class Key>
class ChangeLog {
 public:
  void touch(const Key& key) {
    const auto [place, added] = revisions_.try_emplace(key, newest_ + 1);
    if (!added) keys_.erase(place->second);
    place->second = ++newest_;
    keys_.emplace(newest_, key);
  }
  void clear() {
    keys_.clear();
    revisions_.clear();
  }
  /// Calls visit(key, revision) for each key that changed after `revision`, oldest change first, until it says false.
  void after(std::uint64_t revision, auto visit) const {
    for (auto entry = keys_.upper_bound(revision); entry != keys_.end(); ++entry)
      if (!visit(entry->second, entry->first)) return;
  }
  std::uint64_t newest() const { return newest_; }

 private:
  std::map<std::uint64_t, Key> keys_;
  std::unordered_map<Key, std::uint64_t> revisions_;
  std::uint64_t newest_ = 0;
};

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
  std::int64_t stamp_ns = 0;
  float sigma_m = 0;  ///< standard deviation in the direction in which it is largest
  msg::TrackingState state = msg::TrackingState::kOk;
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
  /// A measured camera pose. Those in maps other than the first are left out.
  void add_position(const msg::TrackingResult& result);
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
