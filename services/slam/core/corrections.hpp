// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "common/geometry/se3.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/map/trajectory.hpp"
#include "services/slam/core/mapping/mapper.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// Frame `odom`: poses in it stay smooth when the map is corrected, because T_map_odom takes the jump up. Small
/// corrections, as local bundle adjustment makes them, stay in the odometry: there it does not drift from the map.
class OdometryFrame {
 public:
  explicit OdometryFrame(const LoopConfig& config) : config_(config) {}

  /// The map moved a camera from one pose to another. True when T_map_odom took that up.
  bool correct(const Eigen::Isometry3d& T_map_before, const Eigen::Isometry3d& T_map_after) {
    const Eigen::Isometry3d T_before_after = T_map_before.inverse() * T_map_after;
    if (T_before_after.translation().norm() <= config_.max_odometry_step_m &&
        geometry::rotation_angle_rad(T_before_after) <= config_.max_odometry_step_rad) {
      return false;
    }
    T_map_odom_ = geometry::normalized(T_map_after * T_map_before.inverse() * T_map_odom_);
    return true;
  }
  const Eigen::Isometry3d& T_map_odom() const { return T_map_odom_; }

 private:
  LoopConfig config_;
  Eigen::Isometry3d T_map_odom_ = Eigen::Isometry3d::Identity();
};

/// Frames next to an old map, which odometry alone has placed. What it was wrong by when the map is recognised again is
/// spread evenly over them. docs/theory/tracking.md, "Odometry".
class OdometryStretch {
 public:
  void add(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) { frames_.push_back({seq, T_world_camera}); }
  /// Of the frames so far, given the next one: where odometry expects it, and where the map shows it.
  std::vector<PoseCorrection> spread(const Eigen::Isometry3d& T_world_expected,
                                     const Eigen::Isometry3d& T_world_found) const;
  void clear() { frames_.clear(); }

 private:
  std::vector<std::pair<std::uint64_t, Eigen::Isometry3d>> frames_;  ///< seq, T_world_camera
};

/// Keyframe changes that wait to be published. A closed loop moves thousands of keyframes at once. Their corrections
/// leave in portions that fit into every reader's history, newest keyframes first; a keyframe that moves again before
/// its turn is published once, with its last pose. New and removed keyframes never wait behind corrections.
class KeyframeChangeQueue {
 public:
  void add(const std::vector<KeyframeChange>& changes);
  std::vector<KeyframeChange> take(std::size_t count);
  bool empty() const { return in_order_.empty() && corrected_.empty(); }

 private:
  std::deque<KeyframeChange> in_order_;  ///< created and removed
  std::map<KeyframeId, KeyframeChange> corrected_;
};

/// Frames that were tracked while surfaces were in question, and so without them. When it is known what rests, their
/// poses are found again with all of it. docs/theory/tracking.md, "Surfaces in question".
class DeferredFrames {
 public:
  /// Takes in the next tracked frame. Once nothing has been in question for long enough that keyframes have seen it,
  /// those that wait are judged again in `map`. A frame keeps its pose in `frames` where its keyframe is not in the map
  /// or too few landmarks agree; one that is no longer recorded does not count.
  void add(const TrackedFrame& tracked, const LocalMap& map, const TrackingContext& context,
           std::vector<FrameRecord>& frames);

 private:
  std::vector<TrackedFrame> waiting_;
  std::int64_t in_question_ns_ = 0;  ///< stamp of the last frame that had something in question
};

}  // namespace rtd::slam
