// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <optional>
#include <thread>

#include "common/service/runtime.hpp"
#include "services/slam/config.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/robot_base.hpp"
#include "services/slam/slam_messages.hpp"

namespace rtd::slam {

/// Puts what slam found on the bus: keyframe events and the result for our own services, the ROS 2 messages for all.
/// One thread, that of the frames; the point cloud is published from a thread of its own, because copying the map may
/// wait for a bundle adjustment.
class SlamPublisher {
 public:
  /// `points` copies the map; called from another thread.
  SlamPublisher(const ServiceConfig& config, bus::Bus& bus, std::function<std::vector<MapPoint>()> points);
  ~SlamPublisher();
  SlamPublisher(const SlamPublisher&) = delete;
  SlamPublisher& operator=(const SlamPublisher&) = delete;

  /// The keyframe changes of `output` first, so that a reader of the result knows them all; then its `result` and, when
  /// tracked, the pose.
  void publish(const SlamOutput& output, const msg::TrackingResult& result);
  /// The result again, for a frame that was sent again.
  void repeat(const msg::TrackingResult& result) { tracking_.write(result); }
  void publish_diagnostics(msg::DiagnosticArray diagnostics);
  /// The map is another one: its path begins with the next pose.
  void begin_path() { poses_.clear(); }
  /// The results have a reader.
  bool matched() const { return tracking_.matched() > 0; }

 private:
  void publish_pose(const msg::TrackingResult& result);
  void publish_path();
  void publish_clouds();

  const ServiceConfig config_;
  const FrameNames names_;
  const std::optional<RobotBase> base_;
  const std::string robot_;
  const std::function<std::vector<MapPoint>()> points_;
  bus::Writer<msg::KeyframeEvent> keyframes_;
  bus::Writer<msg::TrackingResult> tracking_;
  bus::Writer<msg::Odometry> odometry_;
  bus::Writer<msg::PoseStamped> pose_;
  bus::Writer<msg::TFMessage> tf_;
  bus::Writer<msg::Path> path_;
  bus::Writer<msg::PointCloud2> map_points_;
  bus::Writer<msg::DiagnosticArray> diagnostics_;
  std::optional<OdometryPose> previous_;  ///< last tracked one, for the twist
  std::deque<msg::PoseStamped> poses_;
  std::int64_t path_published_ns_ = 0;
  std::atomic<std::int64_t> newest_stamp_ns_{-1};  ///< -1: nothing tracked yet
  service::StopToken ended_;
  std::thread cloud_thread_;
};

}  // namespace rtd::slam
