// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/camera_tree.hpp"

#include <array>
#include <mutex>
#include <utility>

#include "common/geometry/se3.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::slam {
namespace {

using geometry::Matrix6d;

Eigen::Isometry3d to_isometry(const msg::Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << pose.position.x, pose.position.y, pose.position.z;
  const msg::Quaternion& q = pose.orientation;
  T.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  return T;
}

msg::Pose to_pose(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q(T.linear());
  const Eigen::Vector3d t = T.translation();
  return {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

msg::Pose of_base(const msg::Pose& camera, const RobotBase& base) {
  return to_pose(to_isometry(camera) * base.T_base_camera.inverse());
}

void transform_covariance(std::array<double, 36>& covariance, const Matrix6d& J) {
  Eigen::Map<geometry::RowMajor6d> matrix(covariance.data());
  matrix = (J * Matrix6d(matrix) * J.transpose()).eval();
}

}  // namespace

Eigen::Isometry3d level_camera() {
  return Eigen::Isometry3d(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5));
}

void move_to_base(msg::PoseStamped& pose, const RobotBase& base) {
  pose.pose = of_base(pose.pose, base);
}

void move_to_base(msg::Odometry& odometry, const RobotBase& base) {
  // The base is off the camera by r, in the axes of the world: an error of the rotation swings it.
  const Eigen::Isometry3d T_odom_camera = to_isometry(odometry.pose.pose);
  const Eigen::Vector3d r = T_odom_camera.linear() * base.T_base_camera.inverse().translation();
  odometry.pose.pose = of_base(odometry.pose.pose, base);
  transform_covariance(odometry.pose.covariance, geometry::lever_arm(r));

  auto& [linear, angular] = odometry.twist.twist;
  const Matrix6d A = geometry::adjoint(base.T_base_camera);
  geometry::Vector6d twist;
  twist << linear.x, linear.y, linear.z, angular.x, angular.y, angular.z;
  twist = (A * twist).eval();
  linear = {twist[0], twist[1], twist[2]};
  angular = {twist[3], twist[4], twist[5]};
  transform_covariance(odometry.twist.covariance, A);
  odometry.child_frame_id = base.frame;
}

void move_to_base(msg::TFMessage& tf, const RobotBase& base) {
  msg::TransformStamped& link = tf.transforms.back();
  const auto set = [](msg::TransformStamped& transform, const msg::Pose& pose) {
    transform.transform = {{pose.position.x, pose.position.y, pose.position.z}, pose.orientation};
  };
  msg::TransformStamped to_camera = link;
  to_camera.header.frame_id = base.frame;
  set(to_camera, to_pose(base.T_base_camera));
  const auto& [t, q] = link.transform;
  set(link, of_base({{t.x, t.y, t.z}, q}, base));
  link.child_frame_id = base.frame;
  if (base.publish_camera) tf.transforms.push_back(std::move(to_camera));
}

/// Filled by a thread of the bus.
struct CameraTree::Transforms {
  void add(msg::TFMessage message) {
    constexpr std::uint64_t kMost = 4096;  // messages: they are to last
    for (msg::TransformStamped& transform : message.transforms) transform.header.stamp = {};  // one each, the newest
    const std::lock_guard lock(mutex);
    if (revision < kMost) log.add(message);
    ++revision;
  }

  std::mutex mutex;
  geometry::TransformLog log;
  std::uint64_t revision = 1;
};

CameraTree::CameraTree(const ServiceConfig& config, service::Runtime& runtime)
    : configured_(config.camera_frame),
      map_(runtime.bus.frame(config.map_frame)),
      odom_(runtime.bus.frame(config.odom_frame)),
      base_given_(config.base.given()),
      runtime_(runtime),
      transforms_(std::make_shared<Transforms>()) {
  if (base_given_) return;
  reader_ = runtime.bus.reader<msg::TFMessage>(
      bus::topics::kTfStatic,
      [into = transforms_](const std::shared_ptr<const msg::TFMessage>& message) { into->add(*message); });
}

const CameraTree::Camera& CameraTree::camera() {
  if (camera_.frame.empty()) await_name();
  std::string frame = service::camera_frame(runtime_.heartbeat, runtime_.bus, configured_);
  const std::lock_guard lock(transforms_->mutex);
  if (frame == camera_.frame && transforms_->revision == revision_) return camera_;
  revision_ = transforms_->revision;
  camera_ = {frame, find_root(frame)};
  return camera_;
}

/// Heartbeats come five times a second, and a slam that was restarted may have missed them.
void CameraTree::await_name() const {
  constexpr std::int64_t kMostNs = 500'000'000;
  constexpr std::chrono::milliseconds kLook{10};
  const std::int64_t give_up_ns = service::monotonic_ns() + kMostNs;
  while (!service::knows_camera_frame(runtime_.heartbeat, configured_) && runtime_.heartbeat.alive("camera") &&
         service::monotonic_ns() < give_up_ns && !runtime_.stop.wait_for(kLook)) {
  }
}

/// Under the lock of the transforms.
std::optional<RobotBase> CameraTree::find_root(const std::string& frame) const {
  if (base_given_) return std::nullopt;
  auto [root, T_root_camera] = transforms_->log.root_of(frame);
  if (root == geometry::bare_frame(frame) || root == map_ || root == odom_) return std::nullopt;
  return RobotBase{std::move(root), T_root_camera, false};
}

}  // namespace rtd::slam
