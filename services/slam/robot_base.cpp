// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/robot_base.hpp"

#include <array>

#include "common/geometry/se3.hpp"

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

}  // namespace rtd::slam
