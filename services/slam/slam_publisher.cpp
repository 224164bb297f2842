// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_publisher.hpp"

#include "common/service/monotonic_clock.hpp"

namespace rtd::slam {
namespace {

std::optional<RobotBase> base_of(const BaseConfig& config, const bus::Bus& bus) {
  if (!config.given()) return std::nullopt;
  return RobotBase{bus.frame(config.frame), parse_mount(config.camera), config.publish_camera};
}

}  // namespace

SlamPublisher::SlamPublisher(const ServiceConfig& config, bus::Bus& bus, std::function<std::vector<MapPoint>()> points)
    : config_(config),
      names_{bus.frame(config.map_frame), bus.frame(config.odom_frame), bus.frame(config.camera_frame)},
      base_(base_of(config.base, bus)),
      robot_(bus.robot()),
      points_(std::move(points)),
      keyframes_(bus.writer(bus::topics::kKeyframes)),
      tracking_(bus.writer(bus::topics::kTracking)),
      odometry_(bus.writer(bus::topics::kOdometry)),
      pose_(bus.writer(bus::topics::kPose)),
      tf_(bus.writer(bus::topics::kTf)),
      path_(bus.writer(bus::topics::kPath)),
      map_points_(bus.writer(bus::topics::kMapPoints)),
      diagnostics_(bus.writer(bus::topics::kDiagnostics)),
      cloud_thread_([this] { publish_clouds(); }) {}

SlamPublisher::~SlamPublisher() {
  ended_.request_stop();
  cloud_thread_.join();
}

void SlamPublisher::publish(const SlamOutput& output, const msg::TrackingResult& result) {
  for (const msg::KeyframeEvent& event : make_events(output)) keyframes_.write(event);
  tracking_.write(result);
  const bool measured = msg::is_measured(result.state);
  // From a predicted pose to a measured one the estimate may step: that is no velocity.
  if (measured && previous_ && !msg::is_measured(previous_->result.state)) previous_.reset();
  if (previous_ && previous_->result.map_id != result.map_id) previous_.reset();
  if (!msg::has_pose(result.state)) {
    previous_.reset();
    return;
  }
  const OdometryPose smooth = to_odometry_frame(result, output.T_map_odom);
  msg::Odometry odometry = make_odometry(smooth, previous_, names_);
  msg::TFMessage tf = make_tf(smooth, output.T_map_odom, names_);
  if (base_) {
    move_to_base(odometry, *base_);
    move_to_base(tf, *base_);
  }
  odometry_.write(odometry);
  tf_.write(tf);
  previous_ = smooth;
  if (measured) publish_pose(result);
}

/// All publishers share its topic.
void SlamPublisher::publish_diagnostics(msg::DiagnosticArray diagnostics) {
  for (msg::DiagnosticStatus& status : diagnostics.status) status.name = bus::frame_of_robot(status.name, robot_);
  diagnostics_.write(diagnostics);
}

void SlamPublisher::publish_pose(const msg::TrackingResult& result) {
  msg::PoseStamped pose = make_pose(result, names_);
  if (base_) move_to_base(pose, *base_);
  pose_.write(pose);
  newest_stamp_ns_ = result.stamp_ns;
  if (!poses_.empty() && poses_.back().header.frame_id != pose.header.frame_id) poses_.clear();  // one path, one frame
  poses_.push_back(std::move(pose));
  while (poses_.size() > static_cast<std::size_t>(config_.path_length)) poses_.pop_front();
  publish_path();
}

void SlamPublisher::publish_path() {
  const std::int64_t now_ns = service::monotonic_ns();
  if (path_.matched() == 0 || now_ns - path_published_ns_ < std::int64_t{config_.path_period_ms} * 1'000'000) return;
  path_published_ns_ = now_ns;
  path_.write({poses_.back().header, {poses_.begin(), poses_.end()}});
}

void SlamPublisher::publish_clouds() {
  constexpr int kRest = 20;  // times the work: a large map is published more rarely
  std::chrono::nanoseconds pause = std::chrono::milliseconds(config_.map_period_ms);
  while (!ended_.wait_for(pause)) {
    const std::int64_t stamp_ns = newest_stamp_ns_, start_ns = service::monotonic_ns();
    if (stamp_ns >= 0) map_points_.write(make_cloud(points_(), stamp_ns, names_.map));
    pause = std::max<std::chrono::nanoseconds>(std::chrono::milliseconds(config_.map_period_ms),
                                               kRest * std::chrono::nanoseconds(service::monotonic_ns() - start_ns));
  }
}

}  // namespace rtd::slam
