// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_publisher.hpp"

#include <algorithm>
#include <utility>

#include "common/msg/camera_frame.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::slam {
namespace {

std::optional<RobotBase> base_of(const BaseConfig& config, const bus::Bus& bus) {
  if (!config.given()) return std::nullopt;
  return RobotBase{bus.frame(config.frame), parse_mount(config.camera), config.publish_camera};
}

}  // namespace

SlamPublisher::SlamPublisher(const ServiceConfig& config, bus::Bus& bus, MapPoints points)
    : config_(config),
      names_{bus.frame(config.map_frame), bus.frame(config.odom_frame), bus.frame(msg::kCameraFrame),
             bus.frame("previous_" + config.map_frame)},
      base_(base_of(config.base, bus)),
      robot_(bus.robot()),
      points_(std::move(points)),
      keyframes_(bus.writer(bus::topics::kKeyframes)),
      tracking_(bus.writer(bus::topics::kTracking)),
      odometry_(bus.writer(bus::topics::kOdometry)),
      pose_(bus.writer(bus::topics::kPose)),
      tf_(bus.writer(bus::topics::kTf)),
      map_jumps_(bus.writer(bus::topics::kMapJumps)),
      path_(bus.writer(bus::topics::kPath)),
      map_points_(bus.writer(bus::topics::kMapPoints)),
      diagnostics_(bus.writer(bus::topics::kDiagnostics)),
      cloud_thread_([this] { publish_clouds(); }) {}

SlamPublisher::~SlamPublisher() {
  ended_.request_stop();
  cloud_thread_.join();
}

void SlamPublisher::name_camera(const CameraTree::Camera& camera) {
  names_.camera = camera.frame;
  root_ = camera.root;
}

void SlamPublisher::publish(const SlamOutput& output, const msg::TrackingResult& result) {
  std::optional<OdometryPose> smooth;
  if (msg::has_pose(result.state)) {
    smooth = to_odometry_frame(result, output.T_map_odom);
    follow_world({output.T_map_odom, result.map_id}, result.stamp_ns);
    publish_tf(*smooth, output.T_map_odom);
  }
  for (const msg::KeyframeEvent& event : make_events(output)) keyframes_.write(event);
  tracking_.write(result);
  const bool measured = msg::is_measured(result.state);
  // From a predicted pose to a measured one the estimate may step: that is no velocity.
  const bool steps = measured && previous_ && !msg::is_measured(previous_->result.state);
  if (!smooth || steps || (previous_ && previous_->result.map_id != result.map_id)) previous_.reset();
  if (smooth) publish_odometry(*smooth);
  if (measured) publish_pose(result);
}

void SlamPublisher::begin_map() {
  another_map_ = true;
  poses_.clear();
  const std::lock_guard lock(cloud_mutex_);
  ++cloud_.jumps;
}

/// Another map is `map` from now on, or the same was corrected.
void SlamPublisher::follow_world(const World& world, std::int64_t stamp_ns) {
  const std::optional<World> before = std::exchange(world_, world);
  const bool same_map = !std::exchange(another_map_, false) && before && before->map == world.map;
  if (!before || (same_map && before->T_map_odom.matrix() == world.T_map_odom.matrix())) return;
  map_jumps_.write(make_jump(world.T_map_odom * before->T_map_odom.inverse(), same_map, stamp_ns, names_));
  if (!same_map) poses_.clear();
  const std::lock_guard lock(cloud_mutex_);
  ++cloud_.jumps;
}

void SlamPublisher::publish_tf(const OdometryPose& smooth, const Eigen::Isometry3d& T_map_odom) {
  msg::TFMessage tf = make_tf(smooth, T_map_odom, names_);
  if (const std::optional<RobotBase>& joint = base_ ? base_ : root_) move_to_base(tf, *joint);
  tf_.write(tf);
}

void SlamPublisher::publish_odometry(const OdometryPose& smooth) {
  msg::Odometry odometry = make_odometry(smooth, previous_, names_);
  if (base_) move_to_base(odometry, *base_);
  odometry_.write(odometry);
  previous_ = smooth;
}

/// All publishers share its topic. The hardware is the robot or, where it has no name, the computer.
void SlamPublisher::publish_diagnostics(msg::DiagnosticArray diagnostics) {
  for (msg::DiagnosticStatus& status : diagnostics.status) {
    status.name = bus::frame_of_robot(status.name, robot_);
    status.hardware_id = robot_.empty() ? service::host_name() : robot_;
  }
  diagnostics_.write(diagnostics);
}

void SlamPublisher::publish_pose(const msg::TrackingResult& result) {
  msg::PoseStamped pose = make_pose(result, names_);
  if (base_) move_to_base(pose, *base_);
  pose_.write(pose);
  {
    const std::lock_guard lock(cloud_mutex_);
    cloud_.stamp_ns = result.stamp_ns;
    cloud_.map = result.map_id;
  }
  poses_.push_back(std::move(pose));
  while (poses_.size() > static_cast<std::size_t>(config_.path_length)) poses_.pop_front();
  publish_path();
}

void SlamPublisher::publish_path() {
  const std::int64_t now_ns = service::monotonic_ns();
  if (path_.matched() == 0 || now_ns - path_published_ns_ < std::int64_t{config_.path_period_ms} * 1'000'000) return;
  path_published_ns_ = now_ns;
  path_.write(make_path(poses_));
}

SlamPublisher::CloudMoment SlamPublisher::cloud_moment() {
  const std::lock_guard lock(cloud_mutex_);
  return cloud_;
}

void SlamPublisher::publish_clouds() {
  constexpr int kRest = 20;  // times the work: a large map is published more rarely
  const std::chrono::nanoseconds period = std::chrono::milliseconds(config_.map_period_ms);
  std::chrono::nanoseconds pause = period;
  while (!ended_.wait_for(pause)) {
    pause = period;
    const CloudMoment moment = cloud_moment();
    if (moment.stamp_ns < 0) continue;
    const std::int64_t start_ns = service::monotonic_ns();
    const msg::PointCloud2 cloud = make_cloud(points_(moment.map), moment.stamp_ns, names_.map);
    if (cloud_moment().jumps == moment.jumps) map_points_.write(cloud);
    pause = std::max(period, kRest * std::chrono::nanoseconds(service::monotonic_ns() - start_ns));
  }
}

}  // namespace rtd::slam
