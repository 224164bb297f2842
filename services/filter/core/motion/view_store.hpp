// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/stamps.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

/// What is kept of a frame so that later frames can be compared with it.
struct View {
  std::uint64_t seq = 0;
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  bool posed_by_slam = false;
  bool settled =
      true;  ///< its pose was found against a view old enough to separate movers from the camera: fit as a reference
  DepthGrid grid;
  std::vector<std::uint8_t> dynamic;   ///< per cell, 1 = something moved here
  std::vector<msg::Feature> features;  ///< judged ones
};

/// Which views are worth comparing with.
struct ReferenceLimits {
  std::size_t count = 6;
  double max_baseline_m = 0.8;  ///< of a keyframe: from farther away it saw other sides of things
};

/// The views of the last second, some of the two seconds before and those of the last keyframes, bounded in number
/// (about 0.4 MB each), with their poses.
///
/// Poses come from the quick estimate until slam sends better ones; later poses are then corrected as well. If slam's
/// pose is far from the estimate, slam has started a new map or relocalised: older views are dropped, because they lie
/// in another world.
class ViewStore {
 public:
  void add(View view);
  /// Takes slam's pose of a frame. Returns false if the older views were dropped.
  bool correct(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera);
  /// The frame is a keyframe: its view is kept longer. If slam has moved a recent keyframe far, it has corrected its
  /// map: recent and past views move along, so that they still fit together, and the result is false. Other keyframes
  /// wait for an event of their own.
  bool mark_keyframe(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera);
  void forget_keyframe(std::uint64_t seq);
  /// Keeps this frame, later ones and the newest view; earlier ones belong to another world.
  void forget_before(std::uint64_t seq);
  void clear();

  bool empty() const { return recent_.empty(); }
  /// The newest view. Precondition: not empty.
  const View& newest() const { return recent_.back(); }
  /// The view before the newest one; null when there is none.
  const View* second_newest() const { return recent_.size() < 2 ? nullptr : &recent_[recent_.size() - 2]; }
  /// Is there a view at least this old?
  bool spans(std::int64_t now_ns, std::int64_t age_ns) const {
    return !recent_.empty() && msg::minus_ns(now_ns, recent_.front().stamp_ns) >= age_ns;
  }
  /// The recent view with this stamp; null when there is none.
  const View* at(std::int64_t stamp_ns) const;
  /// Constant velocity: the pose at which the camera would be then; at rest after a long gap. Precondition: not empty.
  Eigen::Isometry3d predict_pose(std::int64_t stamp_ns) const;
  /// The settled recent view whose age is nearest to the wanted one. Precondition: not empty.
  const View& of_age(std::int64_t now_ns, std::int64_t age_ns) const;
  /// The settled view whose age is nearest to the wanted one, also from before the recent ones. Precondition: not
  /// empty.
  const View& long_ago(std::int64_t now_ns, std::int64_t age_ns) const;
  /// Up to `count` views to compare a camera at this pose with: recent ones of graded ages, then keyframes older than
  /// those whose camera stood near and looked the same way.
  std::vector<const View*> references(std::int64_t now_ns, const Eigen::Isometry3d& T_world_camera,
                                      const ReferenceLimits& limits) const;
  /// The keyframes whose camera stood near and looked the same way, nearest first; recent ones too.
  std::vector<const View*> near_keyframes(const Eigen::Isometry3d& T_world_camera, const ReferenceLimits& limits) const;
  std::size_t size() const { return recent_.size() + past_.size() + keyframes_.size(); }

  static constexpr std::int64_t kRecentNs = 1'050'000'000;
  static constexpr std::size_t kMinRecent = 16, kMaxRecent = 64;  ///< slam's answers may be late at a low rate
  static constexpr std::size_t kMaxPast = 8;
  static constexpr std::size_t kMaxKeyframes = 16;

 private:
  void retire_oldest();
  void move_along(const Eigen::Isometry3d& T_new_old);
  std::deque<View> recent_;     ///< by seq
  std::deque<View> past_;       ///< by seq, settled ones from before the recent ones, a quarter of a second apart
  std::deque<View> keyframes_;  ///< by seq
};

}  // namespace rtd::filter
