// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/ros.hpp"
#include "common/msg/tracking.hpp"
#include "services/slam/core/slam_system.hpp"

namespace rtd::slam {

/// What is in view, as far as it matters for the pose: docs/integrity.md, "Crowded or lost".
enum class ViewState { kClear, kCrowded, kContradicted, kBlind, kUnknown };
/// For diagnostics: "crowded".
const char* to_string(ViewState view);

/// How far a pose can be trusted, and why not further.
struct PoseTrust {
  ViewState view = ViewState::kUnknown;
  double agreement = 0;     ///< share of the recognised landmarks that agree closely with the pose; 0 without one
  double view_removed = 0;  ///< share of the features that the filter removed as moving, over half a second
  double since_ok_s = 0;    ///< since the last frame in state ok, else since the first frame
  double position_sigma_m = 1000, rotation_sigma_deg = 180;  ///< along the worst axis; these values: unknown
};

/// Follows the results of slam, frame by frame. Not thread-safe.
class TrustMonitor {
 public:
  PoseTrust add(const msg::TrackingResult& result, double agreement);

 private:
  double follow_view(const msg::TrackingResult& result);

  std::optional<std::int64_t> last_ok_ns_, last_ns_;
  double view_removed_ = 0;
};

/// Names of the coordinate frames on the wire, docs/frames.md.
struct FrameNames {
  std::string map, odom, camera;
  std::string previous_map;  ///< where another map was `map` before
};

/// What the driver of the wheels says, as the core takes it.
WheelSample to_sample(const msg::Odometry& odometry);

/// The result for our own services; the caller fills in published_ns and finished_ns. Without a pose, or where it is
/// not known, the covariance is huge.
msg::TrackingResult make_result(const FrameResult& result);
/// One event for each change, in their order.
std::vector<msg::KeyframeEvent> make_events(const SlamOutput& output);

msg::Pose to_pose(const msg::Transform& T);
msg::TransformStamped make_transform(std::int64_t stamp_ns, const std::string& parent, const std::string& child,
                                     const msg::Transform& T_parent_child);
msg::PoseStamped make_pose(const msg::TrackingResult& result, const FrameNames& names);

/// A result with pose and covariance in frame odom.
struct OdometryPose {
  msg::TrackingResult result{};
  Eigen::Isometry3d T_odom_camera = Eigen::Isometry3d::Identity();  ///< as readers of the result compute it
};
OdometryPose to_odometry_frame(const msg::TrackingResult& result, const Eigen::Isometry3d& T_map_odom);
/// map -> odom, which takes up the jumps when the map is corrected, and odom -> camera, which is smooth.
msg::TFMessage make_tf(const OdometryPose& pose, const Eigen::Isometry3d& T_map_odom, const FrameNames& names);
/// A step of map -> odom: takes coordinates in `map` from before the frame with this stamp to those since. Its child is
/// `map` as it was: the same map, corrected, or another one.
msg::TransformStamped make_jump(const Eigen::Isometry3d& T_now_before, bool same_map, std::int64_t stamp_ns,
                                const FrameNames& names);
/// Pose with covariance, and the twist in the camera frame: the motion since `previous` (earlier stamp) divided by the
/// time; zero without it, and its covariance huge.
msg::Odometry make_odometry(const OdometryPose& pose, const std::optional<OdometryPose>& previous,
                            const FrameNames& names);
/// Up to the newest of the poses, oldest first; of very many every n-th, so that the message may be sent.
msg::Path make_path(const std::deque<msg::PoseStamped>& poses);
/// x y z and intensity (the static probability), all float32. Of very many points some.
msg::PointCloud2 make_cloud(const std::vector<MapPoint>& points, std::int64_t stamp_ns, const std::string& map_frame);

/// Counters of the adapter.
struct SlamCounters {
  std::uint64_t frames = 0, tracked = 0, doubtful = 0, predicted = 0, dropped = 0, duplicates = 0, invalid_features = 0,
                unusable_frames = 0, source_restarts = 0, loops = 0;
};
/// One status "rtd-slam: tracking".
msg::DiagnosticArray make_diagnostics(const msg::TrackingResult& result, const PoseTrust& trust,
                                      const SlamCounters& counters, const std::string& trouble, std::int64_t stamp_ns);

}  // namespace rtd::slam
