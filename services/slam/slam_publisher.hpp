// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/service/runtime.hpp"
#include "services/slam/camera_tree.hpp"
#include "services/slam/config.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/slam_messages.hpp"

namespace rtd::slam {

/// Puts what slam found on the bus: keyframe events and the result for our own services, the ROS 2 messages for all.
/// One thread, that of the frames; the point cloud is published from its own thread, because copying the map may
/// wait for a bundle adjustment.
class SlamPublisher {
 public:
  /// Copies the points of a map; called from another thread.
  using MapPoints = std::function<std::vector<MapPoint>(MapId map)>;

  SlamPublisher(const ServiceConfig& config, bus::Bus& bus, MapPoints points);
  ~SlamPublisher();
  SlamPublisher(const SlamPublisher&) = delete;
  SlamPublisher& operator=(const SlamPublisher&) = delete;

  /// How the camera is called from the next frame on, and where tf joins its tree.
  void name_camera(const CameraTree::Camera& camera);
  /// tf first, because robots wait for it; then the keyframe changes of `output`, so that a reader of the result knows
  /// them all, its `result` and, when tracked, the pose.
  void publish(const SlamOutput& output, const msg::TrackingResult& result);
  /// The result again, for a frame that was sent again.
  void repeat(const msg::TrackingResult& result) { tracking_.write(result); }
  void publish_diagnostics(msg::DiagnosticArray diagnostics);
  /// The map is another one, whatever its number: path and points begin with the next pose.
  void begin_map();
  /// The results have a reader.
  bool matched() const { return tracking_.matched() > 0; }

 private:
  /// map -> odom, and the map that it belongs to.
  struct World {
    Eigen::Isometry3d T_map_odom = Eigen::Isometry3d::Identity();
    MapId map = 0;
  };
  /// What the next cloud shows.
  struct CloudMoment {
    std::int64_t stamp_ns = -1;  ///< -1: nothing tracked yet
    MapId map = 0;
    std::uint64_t jumps = 0;  ///< of the map; a copy that was made during one is not published
  };
  void follow_world(const World& world, std::int64_t stamp_ns);
  void publish_tf(const OdometryPose& smooth, const Eigen::Isometry3d& T_map_odom);
  void publish_odometry(const OdometryPose& smooth);
  void publish_pose(const msg::TrackingResult& result);
  CloudMoment cloud_moment();
  void publish_path();
  void publish_clouds();

  const ServiceConfig config_;
  FrameNames names_;
  const std::optional<RobotBase> base_;
  std::optional<RobotBase> root_;  ///< of the camera's tree
  const std::string robot_;
  const MapPoints points_;
  bus::Writer<msg::KeyframeEvent> keyframes_;
  bus::Writer<msg::TrackingResult> tracking_;
  bus::Writer<msg::Odometry> odometry_;
  bus::Writer<msg::PoseStamped> pose_;
  bus::Writer<msg::TFMessage> tf_;
  bus::Writer<msg::TransformStamped> map_jumps_;
  bus::Writer<msg::Path> path_;
  bus::Writer<msg::PointCloud2> map_points_;
  bus::Writer<msg::DiagnosticArray> diagnostics_;
  std::optional<OdometryPose> previous_;  ///< last tracked one, for the twist
  std::optional<World> world_;            ///< of the last tf
  bool another_map_ = false;              ///< since the last tf
  std::deque<msg::PoseStamped> poses_;
  std::int64_t path_published_ns_ = 0;
  std::mutex cloud_mutex_;  ///< guards cloud_
  CloudMoment cloud_;
  service::StopToken ended_;
  std::thread cloud_thread_;
};

}  // namespace rtd::slam
