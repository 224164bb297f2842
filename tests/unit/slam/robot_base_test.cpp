// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/camera_tree.hpp"

#include <gmock/gmock.h>

#include "common/geometry/se3.hpp"
#include "common/service/config.hpp"

namespace rtd::slam {
namespace {

using geometry::Matrix6d;
using geometry::Vector6d;
using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// Half a metre above the base, 0.2 m in front of its centre, looking forward.
constexpr char kMount[] = "0.2,0,0.5,-0.5,0.5,-0.5,0.5";

RobotBase base(bool publish_camera = true) {
  return {"base_link", parse_mount(kMount), publish_camera};
}

Eigen::Isometry3d isometry(const msg::Point& t, const msg::Quaternion& q) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << t.x, t.y, t.z;
  T.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  return T;
}

msg::Pose message(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q(T.linear());
  return {{T.translation().x(), T.translation().y(), T.translation().z()}, {q.x(), q.y(), q.z(), q.w()}};
}

TEST(ParseMount, a_camera_that_looks_forward_sees_what_is_in_front_of_the_robot) {
  const Eigen::Isometry3d T_base_camera = parse_mount(kMount);
  const Eigen::Vector3d ahead = T_base_camera * Eigen::Vector3d(0, 0, 3);
  EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d(3.2, 0, 0.5), 1e-12)) << ahead.transpose();
  const Eigen::Vector3d below = T_base_camera * Eigen::Vector3d(0, 1, 0);
  EXPECT_TRUE(below.isApprox(Eigen::Vector3d(0.2, 0, -0.5), 1e-12)) << below.transpose();
}

TEST(ParseMount, a_quaternion_of_few_digits_is_made_of_unit_length) {
  const Eigen::Isometry3d T = parse_mount("0,0,0,0,0,0.707,0.707");
  EXPECT_NEAR(T.linear().determinant(), 1, 1e-12);
}

TEST(ParseMount, refuses_what_is_no_pose_and_says_what_one_looks_like) {
  for (const char* text : {"", "1,2,3", "0,0,0,0,0,0,1,", "0,0,0,0,0,0,1,2", "a,0,0,0,0,0,1", "0,0,0,0,0,0,2",
                           "0,0,0,0,0,0,0", "nan,0,0,0,0,0,1", "1e9,0,0,0,0,0,1", "0,0,0x,0,0,0,1"}) {
    EXPECT_THAT([&] { parse_mount(text); },
                testing::ThrowsMessage<service::ConfigError>(testing::HasSubstr("0,0,0.4,-0.5,0.5,-0.5,0.5")))
        << text;
  }
}

TEST(MoveToBase, a_pose_of_the_camera_becomes_that_of_the_base) {
  const RobotBase robot = base();
  const Eigen::Isometry3d T_map_base = geometry::se3_exp((Vector6d() << 1, 2, 0, 0, 0, 0.7).finished());
  msg::PoseStamped pose;
  pose.pose = message(T_map_base * robot.T_base_camera);
  move_to_base(pose, robot);
  EXPECT_TRUE(isometry(pose.pose.position, pose.pose.orientation).isApprox(T_map_base, 1e-12));
}

/// Monte-Carlo free: the derivative of the base's pose by the errors of the camera's, by finite differences.
TEST(MoveToBase, covariance_follows_the_lever_arm) {
  const RobotBase robot = base();
  const Eigen::Isometry3d T_odom_camera = geometry::se3_exp((Vector6d() << 1, -2, 0.3, 0.4, -0.2, 0.9).finished());
  Matrix6d J;
  constexpr double kStep = 1e-6;
  const Eigen::Isometry3d T_odom_base = T_odom_camera * robot.T_base_camera.inverse();
  for (int i = 0; i < 6; ++i) {  // position and rotation of the camera, both in the axes of odom
    Vector6d error = kStep * Vector6d::Unit(i);
    Eigen::Isometry3d T = T_odom_camera;
    T.translation() += error.head<3>();
    T.linear() = geometry::so3_exp(error.tail<3>()) * T.linear();
    T = T * robot.T_base_camera.inverse();
    J.col(i).head<3>() = (T.translation() - T_odom_base.translation()) / kStep;
    J.col(i).tail<3>() = geometry::so3_log(T.linear() * T_odom_base.linear().transpose()) / kStep;
  }
  const Matrix6d A = Matrix6d::Random(), covariance = A * A.transpose();
  msg::Odometry odometry;
  odometry.pose.pose = message(T_odom_camera);
  Eigen::Map<RowMajor6d>(odometry.pose.covariance.data()) = covariance;
  move_to_base(odometry, robot);
  const Matrix6d moved = Eigen::Map<const RowMajor6d>(odometry.pose.covariance.data());
  EXPECT_TRUE(moved.isApprox(J * covariance * J.transpose(), 1e-4));
  EXPECT_EQ(odometry.child_frame_id, "base_link");
}

TEST(MoveToBase, a_turning_robot_has_no_speed_at_its_centre_though_its_camera_has) {
  const RobotBase robot = base();
  constexpr double kGap_s = 1e-3, kTurn_rad_s = 0.8;
  const Eigen::Isometry3d T_before_after =
      robot.T_base_camera.inverse() *
      geometry::se3_exp((Vector6d() << 0, 0, 0, 0, 0, kTurn_rad_s * kGap_s).finished()) * robot.T_base_camera;
  const Vector6d camera = geometry::se3_log(T_before_after) / kGap_s;
  EXPECT_GT(camera.head<3>().norm(), 0.1);
  msg::Odometry odometry;
  odometry.pose.pose = message(Eigen::Isometry3d::Identity());
  odometry.twist.twist = {{camera[0], camera[1], camera[2]}, {camera[3], camera[4], camera[5]}};
  move_to_base(odometry, robot);
  const auto& [linear, angular] = odometry.twist.twist;
  EXPECT_NEAR(Eigen::Vector3d(linear.x, linear.y, linear.z).norm(), 0, 1e-9);
  EXPECT_NEAR(angular.z, kTurn_rad_s, 1e-9);
}

TEST(MoveToBase, tf_goes_through_the_base) {
  const RobotBase robot = base();
  const Eigen::Isometry3d T_odom_camera = geometry::se3_exp(Vector6d::Constant(0.3));
  const msg::Pose pose = message(T_odom_camera);
  msg::TransformStamped link;
  link.header.frame_id = "odom";
  link.child_frame_id = "camera";
  link.transform = {{pose.position.x, pose.position.y, pose.position.z}, pose.orientation};
  msg::TFMessage tf{{link}};
  move_to_base(tf, robot);
  ASSERT_EQ(tf.transforms.size(), 2U);
  Eigen::Isometry3d way = Eigen::Isometry3d::Identity();
  for (const msg::TransformStamped& part : tf.transforms) {
    const auto& [t, q] = part.transform;
    way = way * isometry({t.x, t.y, t.z}, q);
  }
  EXPECT_TRUE(way.isApprox(T_odom_camera, 1e-12));
  EXPECT_EQ(tf.transforms[0].child_frame_id, "base_link");
  EXPECT_EQ(tf.transforms[1].header.frame_id + tf.transforms[1].child_frame_id, "base_linkcamera");
  msg::TFMessage without{{link}};
  move_to_base(without, base(false));
  EXPECT_EQ(without.transforms.size(), 1U) << "a robot description has the camera";
}

}  // namespace
}  // namespace rtd::slam
