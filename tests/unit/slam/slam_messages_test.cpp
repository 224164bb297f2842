// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <map>

#include "common/geometry/pose_list.hpp"
#include "common/geometry/se3.hpp"
#include "common/msg/largest_sample.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/ros_codec/wire.hpp"
#include "common/service/config.hpp"
#include "services/slam/config.hpp"
#include "services/slam/map_keeper.hpp"
#include "services/slam/slam_messages.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::slam {
namespace {

using geometry::Vector6d;
using ::testing::HasSubstr;
using testing::SizeIs;
using ::testing::ThrowsMessage;

const FrameNames kNames{"map", "odom", "camera", "previous_map"};

msg::TrackingResult result_at(std::int64_t stamp_ns, const Eigen::Isometry3d& T_world_camera) {
  msg::TrackingResult result{};
  result.stamp_ns = stamp_ns;
  result.state = msg::TrackingState::kOk;
  result.T_world_camera = msg::to_message(T_world_camera);
  for (std::size_t i = 0; i < 6; ++i) result.covariance[7 * i] = i < 3 ? 1e-4 : 1e-6;
  return result;
}

OdometryPose odometry_at(std::int64_t stamp_ns, const Eigen::Isometry3d& T_odom_camera) {
  return to_odometry_frame(result_at(stamp_ns, T_odom_camera), Eigen::Isometry3d::Identity());
}

TEST(Result, takes_over_pose_covariance_and_counters) {
  FrameResult result;
  result.seq = 7;
  result.state = msg::TrackingState::kOk;
  result.T_world_camera = geometry::se3_exp(Vector6d::Constant(0.3));
  result.covariance(0, 5) = 2;
  result.maps = 3;
  const msg::TrackingResult message = make_result(result);
  EXPECT_EQ(message.seq, 7U);
  EXPECT_EQ(message.state, msg::TrackingState::kOk);
  EXPECT_TRUE(msg::to_isometry(message.T_world_camera).isApprox(result.T_world_camera, 1e-12));
  EXPECT_EQ(message.covariance[5], 2) << "row-major";
  EXPECT_EQ(message.maps, 3U);
}

TEST(KeyframeEvents, are_numbered_without_gaps) {
  SlamOutput output;
  output.result.event_count = 12;
  output.changes = {{KeyframeChange::Kind::kRemoved, 4, 40, 400, Eigen::Isometry3d::Identity()},
                    {KeyframeChange::Kind::kCreated, 5, 50, 500, Eigen::Isometry3d::Identity()}};
  const std::vector<msg::KeyframeEvent> events = make_events(output);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].event_index, 10U);
  EXPECT_EQ(events[1].event_index, 11U);
  EXPECT_EQ(events[0].kind, msg::KeyframeEventKind::kRemoved);
  EXPECT_EQ(events[1].keyframe_id, 5U);
  EXPECT_EQ(events[1].frame_seq, 50U);
}

TEST(Odometry, twist_is_the_motion_per_second_in_the_camera_frame) {
  Eigen::Isometry3d T_world_first = Eigen::Isometry3d::Identity();
  T_world_first.linear() = Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Vector6d twist = (Vector6d() << 0.3, 0, 0.6, 0, 0.9, 0).finished();  // m/s, rad/s
  const auto first = odometry_at(1'000'000'000, T_world_first);
  const auto second = odometry_at(1'100'000'000, T_world_first * geometry::se3_exp(0.1 * twist));
  const msg::Odometry odometry = make_odometry(second, first, kNames);
  EXPECT_NEAR(odometry.twist.twist.linear.x, 0.3, 1e-6);
  EXPECT_NEAR(odometry.twist.twist.linear.z, 0.6, 1e-6);
  EXPECT_NEAR(odometry.twist.twist.angular.y, 0.9, 1e-6);
  EXPECT_NEAR(odometry.twist.covariance[0], 2e-4 / 0.01, 1e-9);
  EXPECT_NEAR(odometry.pose.covariance[35], 1e-6, 1e-12);
  EXPECT_EQ(odometry.header.stamp.nanosec, 100'000'000U);
  EXPECT_EQ(odometry.child_frame_id, "camera");
}

TEST(Odometry, has_no_twist_without_an_earlier_pose) {
  const auto pose = odometry_at(5, Eigen::Isometry3d::Identity());
  EXPECT_EQ(make_odometry(pose, std::nullopt, kNames).twist.twist.linear.x, 0);
  EXPECT_EQ(make_odometry(pose, std::nullopt, kNames).twist.covariance[35], 1e6) << "nothing is known about it";
  EXPECT_EQ(make_odometry(pose, odometry_at(5, geometry::se3_exp(Vector6d::Ones())), kNames).twist.twist.linear.x, 0);
}

TEST(Tf, chains_map_to_odom_to_camera) {
  const Eigen::Isometry3d T_map_odom = geometry::se3_exp((Vector6d() << 0.4, -0.1, 0.2, 0.1, 0.5, -0.2).finished());
  const Eigen::Isometry3d T_map_camera = geometry::se3_exp(Vector6d::Constant(0.7));
  const msg::TFMessage tf = make_tf(to_odometry_frame(result_at(5, T_map_camera), T_map_odom), T_map_odom, kNames);
  ASSERT_EQ(tf.transforms.size(), 2U);
  const auto T = [&](std::size_t i) {
    const auto& [t, q] = tf.transforms[i].transform;
    return msg::to_isometry({{t.x, t.y, t.z}, {q.x, q.y, q.z, q.w}});
  };
  EXPECT_EQ(tf.transforms[0].header.frame_id + ">" + tf.transforms[0].child_frame_id, "map>odom");
  EXPECT_EQ(tf.transforms[1].header.frame_id + ">" + tf.transforms[1].child_frame_id, "odom>camera");
  EXPECT_TRUE(T(0).isApprox(T_map_odom, 1e-12));
  EXPECT_TRUE((T(0) * T(1)).isApprox(T_map_camera, 1e-12));
}

TEST(Odometry, in_its_own_frame_turns_the_covariance_and_keeps_the_twist) {
  const Eigen::Isometry3d T_map_odom(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitZ()));
  msg::TrackingResult result = result_at(5, Eigen::Isometry3d::Identity());
  result.covariance[0] = 9;  // map x is odom -y
  const msg::TrackingResult smooth = to_odometry_frame(result, T_map_odom).result;
  EXPECT_NEAR(smooth.covariance[7], 9, 1e-12);
  EXPECT_NEAR(smooth.covariance[0], 1e-4, 1e-12);
  EXPECT_EQ(to_odometry_frame(result, Eigen::Isometry3d::Identity()).result.covariance, result.covariance);
}

TEST(Cloud, lays_out_floats) {
  const msg::PointCloud2 cloud = make_cloud({{{1, 2, 3}, 0.5F}, {{4, 5, 6}, 1.0F}}, 7'000'000'001, "map");
  ASSERT_EQ(cloud.data.size(), 32U);
  float z = 0, intensity = 0;
  std::memcpy(&z, cloud.data.data() + 16 + cloud.fields[2].offset, 4);
  std::memcpy(&intensity, cloud.data.data() + cloud.fields[3].offset, 4);
  EXPECT_EQ(z, 6);
  EXPECT_EQ(intensity, 0.5F);
  EXPECT_EQ(cloud.header.stamp.sec, 7);
  EXPECT_EQ(make_cloud({}, 0, "map").width, 0U);
}

TEST(Cloud, of_a_huge_map_is_thinned_out_to_what_may_be_sent) {
  const msg::PointCloud2 cloud = make_cloud(std::vector<MapPoint>(1'500'000), 0, std::string(100, 'm'));
  EXPECT_GT(cloud.width, 500'000U);
  EXPECT_LE(ros::encoded_size<ros::Wire::kCdr>(cloud), msg::largest_sample<msg::PointCloud2>());
}

TEST(Path, of_a_day_is_thinned_out_to_what_may_be_sent_and_ends_at_the_camera) {
  std::deque<msg::PoseStamped> poses(1'000'000);  // the most that slam.path_length allows
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].header.frame_id = "a_robot_with_a_name_of_32_letter/map";
    poses[i].pose.position.x = static_cast<double>(i);
  }
  const msg::Path path = make_path(poses);
  EXPECT_LE(ros::encoded_size<ros::Wire::kCdr>(path), msg::largest_sample<msg::Path>());
  EXPECT_EQ(path.poses.front().pose.position.x, 0);
  EXPECT_EQ(path.poses.back().pose.position.x, 999'999);
  poses.resize(2000);
  EXPECT_EQ(make_path(poses).poses.size(), 2000U);
}

TEST(Diagnostics, level_follows_the_trouble) {
  auto result = result_at(0, Eigen::Isometry3d::Identity());
  EXPECT_EQ(make_diagnostics(result, {}, {}, "", 0).status[0].level, 0);
  EXPECT_EQ(make_diagnostics(result, {}, {}, "no features", 0).status[0].level, 1);
  EXPECT_EQ(make_diagnostics(result, {}, {}, "no features", 0).status[0].message, "no features");
  result.state = msg::TrackingState::kLost;
  EXPECT_EQ(make_diagnostics(result, {}, {}, "lost", 0).status[0].level, 2);
}

TEST(Diagnostics, name_what_is_in_view_and_how_far_the_pose_is_known) {
  const PoseTrust trust{ViewState::kCrowded, 0.71, 0.64, 1.5, 0.0123, 0.9};
  const msg::DiagnosticArray diagnostics =
      make_diagnostics(result_at(0, Eigen::Isometry3d::Identity()), trust, {}, "", 0);
  std::map<std::string, std::string> values;
  for (const auto& [key, value] : diagnostics.status[0].values) values[key] = value;
  EXPECT_EQ(values["view"], "crowded");
  EXPECT_EQ(values["agreement"], "0.71");
  EXPECT_EQ(values["since_ok_s"], "1.50");
  EXPECT_EQ(values["position_sigma_m"], "0.012300");
}

TEST(TrackingResult, without_a_pose_has_a_huge_covariance) {
  FrameResult lost;
  lost.state = msg::TrackingState::kLost;
  EXPECT_EQ(make_result(lost).covariance[0], 1e6);
  EXPECT_EQ(make_result(lost).covariance[35], 1e6);
}

TEST(TrackingResult, that_begins_a_map_has_a_small_covariance_and_never_zeros) {
  FrameResult first;
  first.state = msg::TrackingState::kOk;
  const msg::TrackingResult result = make_result(first);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_GT(result.covariance[7 * i], 0) << "robot_localization refuses zeros";
    EXPECT_LT(result.covariance[7 * i], 1e-6);
  }
}

TEST(Config, refuses_unknown_keys_and_values_out_of_range) {
  ServiceConfig config;
  service::ConfigBinder binder;
  binder.section("slam", config);
  binder.set("slam.tracker.min_inliers=40");
  EXPECT_EQ(config.core.tracker.min_inliers, 40);
  EXPECT_THAT([&] { binder.set("slam.tracker.min_inlier=40"); },
              ThrowsMessage<service::ConfigError>(HasSubstr("min_inliers")));
  EXPECT_THAT([&] { binder.set("slam.mapper.redundant_ratio=1.5"); },
              ThrowsMessage<service::ConfigError>(HasSubstr("redundant_ratio")));
}

TEST(SlamConfig, refuses_a_vocabulary_that_is_missing_or_damaged) {
  ServiceConfig config;
  EXPECT_EQ(core_config(config).place.vocabulary, nullptr);  // the core takes the built-in one
  const rtd::test::TemporaryFolder folder;
  config.vocabulary_file = folder.file("none.vocabulary");
  EXPECT_THAT([&] { core_config(config); }, ThrowsMessage<service::ConfigError>(testing::AllOf(
                                                HasSubstr("slam.place.vocabulary: "), HasSubstr("cannot be read"))));
  config.vocabulary_file = folder.write("damaged.vocabulary", "RTDVOC01 and then something else");
  EXPECT_THAT([&] { core_config(config); }, ThrowsMessage<service::ConfigError>(HasSubstr("rtd-train-vocabulary")));
}

TEST(RunFiles, a_trajectory_whose_stamps_go_back_has_a_file_for_each_segment) {
  const rtd::test::TemporaryFolder folder;
  std::vector<StampedPose> poses;
  for (const std::int64_t second : {1, 2, 3, 1, 2}) poses.push_back({second * 1'000'000'000, {}});
  for (StampedPose& pose : poses) pose.T_world_body.setIdentity();
  write_trajectory(poses, folder / "trajectory");
  EXPECT_THAT(geometry::read_pose_list(std::filesystem::path(folder / "trajectory.txt")).poses, SizeIs(3));
  EXPECT_THAT(geometry::read_pose_list(std::filesystem::path(folder / "trajectory_segment_2.txt")).poses, SizeIs(2));
  EXPECT_FALSE(std::filesystem::exists(folder / "trajectory_segment_3.txt"));
  write_trajectory({}, folder / "none");
  EXPECT_TRUE(std::filesystem::exists(folder / "none.txt")) << "empty, but there";
}

}  // namespace
}  // namespace rtd::slam
