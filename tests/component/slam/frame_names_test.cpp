// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// The names of frames never change, whatever becomes of the map: the table of docs/frames.md, "One map at a time".
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "common/bus/commands.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/transform_log.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/slam/slam_service.hpp"
#include "tests/support/frames_table.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/support/two_places.hpp"

namespace rtd::slam {
namespace {

using test_support::Inbox;
using test_support::link;
using test_support::Links;

constexpr double kFrameStep_m = 0.05;
constexpr std::int64_t kLongestGapNs = 500'000'000;  // while the camera finds its place again

Eigen::Isometry3d isometry_of(const msg::RosTransform& transform) {
  return geometry::to_isometry(transform).value_or(Eigen::Isometry3d::Identity());
}

Eigen::Vector3d position_of(const msg::Pose& pose) {
  return {pose.position.x, pose.position.y, pose.position.z};
}

/// A filter before one slam service, and everything that ROS 2 programs receive of it.
class FramesOfMaps : public test_support::ServiceFixture<SlamService> {
 protected:
  FramesOfMaps() : features_(bus_->writer(bus::topics::kFeatures)) {
    receive(bus::topics::kTracking, results_);
    receive(bus::topics::kTf, tf_);
    receive(bus::topics::kOdometry, odometry_);
    receive(bus::topics::kPose, poses_);
    receive(bus::topics::kPath, paths_);
    receive(bus::topics::kMapPoints, clouds_);
    receive(bus::topics::kMapJumps, jumps_);
    config_.core = test_support::settled();
    config_.map_period_ms = 10;
    config_.path_period_ms = 1;
    config_.map.folder = folder_.string();
    std::filesystem::create_directories(folder_);
  }

  msg::TrackingResult show(const msg::FeatureFrame& frame) {
    const std::size_t before = results_.all().size();
    EXPECT_TRUE(features_.write(frame));
    EXPECT_TRUE(results_.wait_count(before + 1)) << "no result for frame " << frame.seq;
    ++next_;
    const msg::TrackingResult result = *results_.all().back();
    if (msg::has_pose(result.state)) {
      EXPECT_TRUE(tf_.wait_count(++with_pose_));
      EXPECT_TRUE(odometry_.wait_count(with_pose_));
    }
    return result;
  }
  msg::TrackingResult look_from(double x_m) {
    T_world_camera_.translation().x() = x_m_ = x_m;
    return show(*places_.view(next_, T_world_camera_));
  }
  /// Until it is there or the number of maps changes.
  void walk_to(double end_m) {
    const std::uint32_t maps = results_.all().back()->maps;
    const double step_m = end_m > x_m_ ? kFrameStep_m : -kFrameStep_m;
    while (std::abs(end_m - x_m_) > kFrameStep_m / 2 && look_from(x_m_ + step_m).maps == maps) {
    }
  }
  void call(const char* command, const std::string& argument = {}) {
    bus::CommandClient client(bus_options_);
    const bus::CommandAnswer answer = client.call(command, argument, 20'000);
    EXPECT_TRUE(answer.success) << answer.message;
  }
  /// Waits for the n-th jump and gives the children of all.
  std::vector<std::string> jumps_after(std::size_t count) {
    EXPECT_TRUE(jumps_.wait_count(count));
    std::vector<std::string> children;
    for (const auto& jump : jumps_.all()) children.push_back(jump->child_frame_id);
    return children;
  }
  std::map<std::string, Links> seen() const {
    std::map<std::string, Links> seen;
    for (const auto& message : tf_.all())
      for (const auto& t : message->transforms) seen["rt/tf"].insert(link(t.header.frame_id, t.child_frame_id));
    for (const auto& m : odometry_.all()) seen["rt/slam/odometry"].insert(link(m->header.frame_id, m->child_frame_id));
    for (const auto& m : jumps_.all()) seen["rt/slam/map_jumps"].insert(link(m->header.frame_id, m->child_frame_id));
    for (const auto& m : poses_.all()) seen["rt/slam/pose"].insert(m->header.frame_id);
    for (const auto& m : clouds_.all()) seen["rt/slam/map_points"].insert(m->header.frame_id);
    for (const auto& m : paths_.all()) {
      seen["rt/slam/path"].insert(m->header.frame_id);
      for (const auto& pose : m->poses) seen["rt/slam/path"].insert(pose.header.frame_id);
    }
    return seen;
  }

  /// Pose and odometry say what tf says at their stamp, and the camera moves in odom as far as it does between frames.
  void expect_one_tree() const {
    std::map<std::int64_t, std::pair<Eigen::Isometry3d, Eigen::Isometry3d>> links;  // map -> odom, odom -> camera
    for (const auto& message : tf_.all()) {
      const auto& [map_odom, odom_camera] = std::tie(message->transforms.at(0), message->transforms.at(1));
      links.emplace(msg::to_ns(map_odom.header.stamp),
                    std::pair(isometry_of(map_odom.transform), isometry_of(odom_camera.transform)));
    }
    for (const auto& pose : poses_.all()) {
      const auto& [T_map_odom, T_odom_camera] = links.at(msg::to_ns(pose->header.stamp));
      EXPECT_LT(((T_map_odom * T_odom_camera).translation() - position_of(pose->pose)).norm(), 1e-9);
    }
    std::optional<std::pair<std::int64_t, Eigen::Vector3d>> before;
    for (const auto& odometry : odometry_.all()) {
      const std::int64_t stamp_ns = msg::to_ns(odometry->header.stamp);
      const Eigen::Vector3d position = position_of(odometry->pose.pose);
      EXPECT_LT((links.at(stamp_ns).second.translation() - position).norm(), 1e-9);
      const bool next_frame = before && stamp_ns - before->first < kLongestGapNs;
      EXPECT_LT(next_frame ? (position - before->second).norm() : 0, 2 * kFrameStep_m) << "at " << stamp_ns;
      before.emplace(stamp_ns, position);
    }
  }

  test_support::TwoPlaces places_;
  Inbox<msg::TrackingResult> results_;
  Inbox<msg::TFMessage> tf_;
  Inbox<msg::Odometry> odometry_;
  Inbox<msg::PoseStamped> poses_;
  Inbox<msg::Path> paths_;
  Inbox<msg::PointCloud2> clouds_;
  Inbox<msg::TransformStamped> jumps_;
  bus::Writer<msg::FeatureFrame> features_;
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();
  double x_m_ = 0;
  std::uint64_t next_ = 0;
  std::size_t with_pose_ = 0;
};

TEST_F(FramesOfMaps, never_change_over_loss_merge_reset_and_load) {
  start(service::Pace::kLockstep);
  look_from(0);
  walk_to(1.5);
  walk_to(-3);
  call("slam/save_map", "desk");
  EXPECT_TRUE(jumps_.all().empty());
  const std::uint32_t desk_landmarks = results_.all().back()->landmarks;
  for (int i = 0; i < 60; ++i) show(*test_support::make_empty_view(next_));

  const double hall_m = test_support::TwoPlaces::kHallX_m + 2;
  msg::TrackingResult result{};
  for (int i = 0; i < 120 && result.state != msg::TrackingState::kOk; ++i) result = look_from(hall_m);
  ASSERT_EQ(result.map_id, 1U) << "lost: another map";
  EXPECT_THAT(jumps_after(1), testing::ElementsAre("previous_map"));
  const std::int64_t in_hall_ns = result.stamp_ns;
  ASSERT_TRUE(paths_.wait([=](const auto& all) {
    return !all.empty() && msg::to_ns(all.back()->poses.front().header.stamp) == in_hall_ns;
  })) << "the path begins again";
  ASSERT_TRUE(clouds_.wait(
      [=](const auto& all) { return !all.empty() && msg::to_ns(all.back()->header.stamp) >= in_hall_ns; }));
  const double in_hall = static_cast<double>(result.landmarks) - desk_landmarks;
  EXPECT_NEAR(clouds_.all().back()->width, in_hall, 0.2 * in_hall) << "points of this map only";

  walk_to(-3);  // until both maps are one
  ASSERT_EQ(results_.all().back()->maps, 1U);
  look_from(x_m_);
  EXPECT_EQ(jumps_after(2).back(), "previous_map");
  call("slam/reset");
  for (int i = 0; i < 3; ++i) look_from(x_m_);
  EXPECT_EQ(jumps_after(3).back(), "previous_map");
  call("slam/load_map", "desk");
  for (int i = 0; i < 10; ++i) look_from(x_m_);
  EXPECT_EQ(jumps_after(4).back(), "previous_map");

  EXPECT_EQ(stop(), service::kOk);
  expect_one_tree();
  const std::map<std::string, Links> table = test_support::table_of_frames();
  for (const auto& [topic, links] : seen()) {
    ASSERT_TRUE(table.contains(topic)) << topic << " is not in the table";
    for (const std::string& each : links) EXPECT_THAT(table.at(topic), testing::Contains(each)) << topic;
  }
}

TEST(SlamPublisher, announces_that_the_same_map_was_corrected) {
  bus::BusOptions options;
  options.vendor = bus::inprocess::vendor();
  options.robot = "anna";
  const auto bus = bus::connect(options);
  Inbox<msg::TransformStamped> jumps;
  const auto reader = bus->reader<msg::TransformStamped>(bus::topics::kMapJumps, [&](auto jump) { jumps.take(jump); });
  SlamPublisher publisher({}, *bus, [](MapId) { return std::vector<MapPoint>(); });
  SlamOutput output;
  output.result.state = msg::TrackingState::kOk;
  const auto publish = [&](std::int64_t stamp_ns, double odom_x_m) {
    output.T_map_odom.translation().x() = odom_x_m;
    output.result.stamp_ns = stamp_ns;
    publisher.publish(output, make_result(output.result));
  };
  publish(1, 0);
  publish(2, 0);
  publish(3, 0.25);
  publish(4, 0.25);
  ASSERT_TRUE(jumps.wait_count(1));
  publisher.begin_map();
  publish(5, 1);
  ASSERT_TRUE(jumps.wait_count(2));
  const msg::TransformStamped corrected = *jumps.at(0), other = *jumps.at(1);
  EXPECT_EQ(corrected.header.frame_id + " " + corrected.child_frame_id, "anna/map anna/map");
  EXPECT_EQ(msg::to_ns(corrected.header.stamp), 3);
  EXPECT_DOUBLE_EQ(corrected.transform.translation.x, 0.25) << "where things are now";
  EXPECT_EQ(other.child_frame_id, "anna/previous_map");
  EXPECT_DOUBLE_EQ(other.transform.translation.x, 0.75);
}

}  // namespace
}  // namespace rtd::slam
