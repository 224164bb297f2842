// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/slam_service.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "common/msg/transform_eigen.hpp"
#include "common/service/config.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;
using test_support::Inbox;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A filter and listeners around one slam service.
class SlamServiceTest : public test_support::ServiceFixture<SlamService> {
 protected:
  SlamServiceTest()
      : features_(bus_->writer(bus::topics::kFeatures)), status_writer_(bus_->writer(bus::topics::kStatus)) {
    receive(bus::topics::kTracking, results_);
    receive(bus::topics::kKeyframes, events_);
    receive(bus::topics::kOdometry, odometry_);
    receive(bus::topics::kTf, tf_);
    receive(bus::topics::kPath, paths_);
    receive(bus::topics::kMapPoints, clouds_);
    receive(bus::topics::kDiagnostics, diagnostics_);
    config_.core = test_support::settled();
    config_.map_period_ms = 20;
    config_.path_period_ms = 1;
  }

  bool send(std::uint64_t seq) { return features_.write(*world_.view(seq, FeatureWorld::T_world_camera(seq))); }
  /// Sends a frame and waits for its result, as the camera does in lockstep.
  void step(std::uint64_t seq) {
    const std::size_t before = results_.all().size();
    ASSERT_TRUE(send(seq));
    ASSERT_TRUE(results_.wait_count(before + 1)) << "no result for frame " << seq;
  }
  std::string read(const char* name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const FeatureWorld world_{{}};
  Inbox<msg::TrackingResult> results_;
  Inbox<msg::KeyframeEvent> events_;
  Inbox<msg::Odometry> odometry_;
  Inbox<msg::TFMessage> tf_;
  Inbox<msg::Path> paths_;
  Inbox<msg::PointCloud2> clouds_;
  Inbox<msg::DiagnosticArray> diagnostics_;
  bus::Writer<msg::FeatureFrame> features_;
  bus::Writer<msg::ServiceStatus> status_writer_;
};

TEST_F(SlamServiceTest, publishes_pose_odometry_and_tf_for_every_frame) {
  start(service::Pace::kLockstep);
  constexpr std::uint64_t kFrames = 20;
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    step(seq);
    ASSERT_TRUE(tf_.wait_count(seq + 1));  // one by one: the pose topics keep the last ten only
    ASSERT_TRUE(odometry_.wait_count(seq + 1));
  }
  const auto results = results_.all();
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const msg::TrackingResult& result = *results[seq];
    EXPECT_EQ(result.seq, seq);
    EXPECT_EQ(result.state, msg::TrackingState::kOk);
    EXPECT_GT(result.finished_ns, 0);
    const Eigen::Isometry3d error =
        msg::to_isometry(result.T_world_camera).inverse() * FeatureWorld::T_world_camera(seq);
    EXPECT_LT(error.translation().norm(), 1e-3);
  }
  const msg::Odometry odometry = *odometry_.all().back();
  EXPECT_EQ(odometry.header.frame_id, "odom");
  EXPECT_EQ(odometry.child_frame_id, "camera_color_optical_frame");
  EXPECT_GT(odometry.pose.covariance[0], 0);
  const Eigen::Isometry3d T_18_19 = FeatureWorld::T_world_camera(18).inverse() * FeatureWorld::T_world_camera(19);
  EXPECT_NEAR(odometry.twist.twist.linear.x, T_18_19.translation().x() * 30, 0.05);  // m/s
  const std::vector<msg::TransformStamped> tf = tf_.all().back()->transforms;
  ASSERT_EQ(tf.size(), 2U);
  EXPECT_EQ(tf[0].header.frame_id + tf[0].child_frame_id, "mapodom");
  EXPECT_EQ(tf[1].header.frame_id + tf[1].child_frame_id, "odomcamera_color_optical_frame");
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning));
}

msg::TransformStamped transform(const char* parent, const char* child, const msg::RosTransform& T) {
  return {{{}, parent}, child, T};
}

TEST_F(SlamServiceTest, names_the_camera_as_its_images_do_and_joins_the_tree_of_its_driver) {
  bus::Writer<msg::TFMessage> driver = bus_->writer(bus::topics::kTfStatic);
  start(service::Pace::kLockstep);
  say("camera", msg::ServiceState::kReady, {{"frame_id.astra_rgb_optical_frame", 1}});
  const auto last_link = [&](std::size_t count) {
    EXPECT_TRUE(tf_.wait_count(count));
    return tf_.all().back()->transforms.back();
  };
  std::size_t frames = 0;
  do {
    step(frames++);
  } while (frames < 100 && last_link(frames).child_frame_id == "camera_color_optical_frame");
  const msg::TransformStamped alone = last_link(frames);
  EXPECT_EQ(alone.header.frame_id + " " + alone.child_frame_id, "odom astra_rgb_optical_frame");
  driver.write({{transform("astra_link", "astra_rgb_frame", {{0.1, 0, 0}, {}}),
                 transform("astra_rgb_frame", "astra_rgb_optical_frame", {{}, {-0.5, 0.5, -0.5, 0.5}})}});
  while (frames < 200 && last_link(frames).child_frame_id != "astra_link") step(frames++);
  const msg::TransformStamped joined = last_link(frames);
  ASSERT_EQ(joined.child_frame_id, "astra_link") << "the optical frame has its parent already";
  EXPECT_EQ(tf_.all().back()->transforms.size(), 2U);
  // The camera looks along z of odom, so the housing is 0.1 m behind it.
  const double camera_z_m = FeatureWorld::T_world_camera(frames - 1).translation().z();
  EXPECT_NEAR(joined.transform.translation.z, camera_z_m - 0.1, 0.02);
  ASSERT_TRUE(odometry_.wait_count(frames));
  EXPECT_EQ(odometry_.all().back()->child_frame_id, "astra_rgb_optical_frame") << "whose pose it is";
}

TEST_F(SlamServiceTest, publishes_poses_of_the_robot_when_it_knows_where_the_camera_is) {
  config_.base.frame = "base_link";
  config_.base.camera = "0.2,0,0.5,-0.5,0.5,-0.5,0.5";
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 20; ++seq) {
    step(seq);
    ASSERT_TRUE(tf_.wait_count(seq + 1));
    ASSERT_TRUE(odometry_.wait_count(seq + 1));
  }
  const auto& start = odometry_.all().front()->pose.pose.position;
  EXPECT_NEAR(std::hypot(start.x, start.y, start.z), 0, 1e-6) << "the map begins at the base";
  const msg::Odometry odometry = *odometry_.all().back();
  EXPECT_EQ(odometry.child_frame_id, "base_link");
  // The camera of this world moves to its right: the robot, which looks along x, to -y.
  const double right_m = FeatureWorld::T_world_camera(19).translation().x();
  ASSERT_GT(right_m, 0.01);
  EXPECT_LT(odometry.pose.pose.position.y, -0.5 * right_m);
  const std::vector<msg::TransformStamped> tf = tf_.all().back()->transforms;
  ASSERT_EQ(tf.size(), 3U);
  EXPECT_EQ(tf[1].header.frame_id + tf[1].child_frame_id, "odombase_link");
  EXPECT_EQ(tf[2].header.frame_id + tf[2].child_frame_id, "base_linkcamera_color_optical_frame");
}

TEST_F(SlamServiceTest, takes_the_mount_of_the_camera_from_the_robots_description) {
  config_.base.camera = "tf";
  bus::Writer<msg::TFMessage> description = bus_->writer(bus::topics::kTfStatic);
  description.write({{transform("base_link", "mast", {{0.2, 0, 0.3}, {}})}});
  launch(service::Pace::kLockstep);
  EXPECT_TRUE(wait_state(msg::ServiceState::kStarting, "camera_color_optical_frame")) << "says what is missing";
  description.write({{transform("mast", "camera_link", {{0, 0, 0.2}, {}}),
                      transform("camera_link", "camera_color_optical_frame", {{}, {-0.5, 0.5, -0.5, 0.5}})}});
  ASSERT_TRUE(wait_state(msg::ServiceState::kReady));
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    step(seq);
    ASSERT_TRUE(tf_.wait_count(seq + 1));
  }
  const Eigen::Isometry3d first = msg::to_isometry(results_.all().front()->T_world_camera);
  EXPECT_TRUE(first.translation().isApprox(Eigen::Vector3d(0.2, 0, 0.5), 1e-9)) << first.translation().transpose();
  EXPECT_TRUE(first.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-9)) << "looks along x";
  const std::vector<msg::TransformStamped> tf = tf_.all().back()->transforms;
  ASSERT_EQ(tf.size(), 2U) << "the description has base to camera";
  EXPECT_EQ(tf[1].child_frame_id, "base_link");
}

TEST_F(SlamServiceTest, ends_when_the_robots_description_does_not_come) {
  config_.base.camera = "tf";
  config_.base.tf_timeout_s = 0.2;
  bus::Writer<msg::TFMessage> description = bus_->writer(bus::topics::kTfStatic);
  description.write({{transform("base_link", "arm", {})}});
  launch(service::Pace::kLockstep);
  EXPECT_THAT([this] { running_code(); }, testing::ThrowsMessage<service::ConfigError>(testing::AllOf(
                                              HasSubstr("'camera_color_optical_frame'"), HasSubstr("rt/tf_static"),
                                              HasSubstr("--camera-in-base x,y,z"))));
}

TEST_F(SlamServiceTest, looks_for_the_floor_and_begins_without_one) {
  config_.base.gravity = "floor";
  config_.base.gravity_wait_frames = 2;
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 3; ++seq) step(seq);
  const auto results = results_.all();
  EXPECT_EQ(results[1]->state, msg::TrackingState::kInitializing);
  ASSERT_EQ(results[2]->state, msg::TrackingState::kOk);
  const Eigen::Isometry3d first = msg::to_isometry(results[2]->T_world_camera);
  EXPECT_TRUE(first.linear().col(1).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9)) << "z up as a level camera has it";
  EXPECT_TRUE(wait_metric("map_z_up", 1));
}

TEST_F(SlamServiceTest, wants_a_topic_for_an_imu) {
  config_.base.gravity = "imu";
  launch(service::Pace::kLockstep);
  EXPECT_THAT([this] { running_code(); }, testing::ThrowsMessage<service::ConfigError>(HasSubstr("--imu TOPIC")));
}

TEST_F(SlamServiceTest, publishes_keyframes_before_the_result_that_counts_them) {
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 40; ++seq) {
    step(seq);
    const std::uint64_t expected = results_.all().back()->event_count;
    ASSERT_TRUE(events_.wait_count(expected)) << "frame " << seq;
  }
  EXPECT_GE(events_.all().size(), 2U);
  EXPECT_EQ(events_.all().front()->kind, msg::KeyframeEventKind::kCreated);
  EXPECT_EQ(events_.all().front()->frame_seq, 0U);
}

TEST_F(SlamServiceTest, repeats_the_result_of_a_repeated_frame) {
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 3; ++seq) step(seq);
  step(2);
  const auto results = results_.all();
  ASSERT_THAT(results, SizeIs(4));
  EXPECT_EQ(std::memcmp(results[2].get(), results[3].get(), sizeof(msg::TrackingResult)), 0);
  step(3);
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kOk);
}

/// A camera sends all frames in flight again, oldest first, when a busy computer answers late.
TEST_F(SlamServiceTest, frames_that_come_late_or_again_publish_no_pose_of_the_past) {
  start(service::Pace::kAsap);
  for (const std::uint64_t seq : {0U, 1U, 2U, 4U, 5U}) step(seq);
  for (const std::uint64_t seq : {4U, 5U}) step(seq);  // answered, but the answers were late
  ASSERT_TRUE(send(3));                                // lost on its way the first time
  step(6);
  const auto results = results_.all();
  ASSERT_THAT(results, SizeIs(8)) << "frame 3 has been answered by 4";
  EXPECT_EQ(std::memcmp(results[3].get(), results[5].get(), sizeof(msg::TrackingResult)), 0);
  EXPECT_EQ(results.back()->state, msg::TrackingState::kOk);
  ASSERT_TRUE(tf_.wait_count(6));
  ASSERT_TRUE(odometry_.wait_count(6));
  const auto tf = tf_.all();
  const auto odometry = odometry_.all();
  ASSERT_THAT(tf, SizeIs(6)) << "each stamp once";
  ASSERT_THAT(odometry, SizeIs(6));
  for (std::size_t i = 0; i < 6; ++i) {
    const std::int64_t stamp_ns = msg::to_ns(odometry[i]->header.stamp);
    EXPECT_EQ(msg::to_ns(tf[i]->transforms[0].header.stamp), stamp_ns);
    EXPECT_GT(stamp_ns, i == 0 ? 0 : msg::to_ns(odometry[i - 1]->header.stamp));
    EXPECT_GT(odometry[i]->pose.covariance[0], 0) << "also of the first pose of a map";
  }
}

TEST_F(SlamServiceTest, publishes_map_path_and_diagnostics) {
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 5; ++seq) step(seq);
  ASSERT_TRUE(clouds_.wait_count(1));
  const msg::PointCloud2 cloud = *clouds_.all().back();
  EXPECT_GT(cloud.width, 100U);
  EXPECT_EQ(cloud.data.size(), cloud.width * 16U);
  EXPECT_THAT(cloud.fields, SizeIs(4));
  ASSERT_TRUE(paths_.wait_count(1));
  EXPECT_EQ(paths_.all().back()->header.frame_id, "map");
  ASSERT_TRUE(
      diagnostics_.wait([](const auto& all) { return !all.empty() && all.back()->status.at(0).message == "ok"; }));
  EXPECT_EQ(diagnostics_.all().back()->status[0].hardware_id, service::host_name());
}

TEST_F(SlamServiceTest, writes_its_files_when_it_stops) {
  config_.out_dir = (folder_ / "run").string();
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 5; ++seq) step(seq);
  EXPECT_EQ(stop(), service::kOk);
  const std::string trajectory = read("run/trajectory.txt");
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), 5);
  EXPECT_THAT(trajectory, HasSubstr("1.000000 0.000000000 0.000000000"));
  EXPECT_FALSE(read("run/keyframes.txt").empty());
  EXPECT_THAT(read("run/map.ply"), HasSubstr("element vertex"));
}

TEST_F(SlamServiceTest, fails_when_the_files_cannot_be_written) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "file") << "not a folder";
  config_.out_dir = (folder_ / "file").string();
  start(service::Pace::kLockstep);
  step(0);
  EXPECT_EQ(stop(), service::kRunFailed);
}

TEST_F(SlamServiceTest, reports_that_the_camera_is_gone_and_keeps_its_map) {
  start(service::Pace::kRealtime);
  for (std::uint64_t seq = 0; seq < 5; ++seq) step(seq);
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "no features for 0.5 s"));
  step(5);
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kOk) << "the map is still there";
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning));
}

TEST_F(SlamServiceTest, a_slow_camera_is_not_gone_between_two_of_its_frames) {
  start(service::Pace::kRealtime);
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    auto frame = world_.view(seq, FeatureWorld::T_world_camera(seq));
    frame->stamp_ns = static_cast<std::int64_t>(seq) * 500'000'000;  // at 2 Hz
    ASSERT_TRUE(features_.write(*frame));
    ASSERT_TRUE(results_.wait_count(seq + 1));
  }
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "no features for 1.5 s"));
}

TEST_F(SlamServiceTest, is_not_troubled_by_the_end_of_the_source) {
  start(service::Pace::kRealtime);
  step(0);
  msg::ServiceStatus camera;
  camera.service = "camera";
  camera.state = msg::ServiceState::kFinished;
  status_writer_.write(camera);
  ASSERT_TRUE(diagnostics_.wait_count(diagnostics_.all().size() + 2)) << "a second and more has passed";
  EXPECT_TRUE(diagnostics_.all().back()->status.at(0).message == "ok");
}

TEST_F(SlamServiceTest, is_degraded_while_tracking_has_no_depth) {
  start(service::Pace::kLockstep);
  auto frame = world_.view(0, Eigen::Isometry3d::Identity());
  for (msg::Feature& feature : frame->features) feature.depth_m = 0;
  features_.write(*frame);
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "features with depth"));
  ASSERT_TRUE(results_.wait_count(1));
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kInitializing);
}

TEST_F(SlamServiceTest, realtime_pace_never_blocks_the_filter) {
  start(service::Pace::kRealtime);
  for (std::uint64_t seq = 0; seq < 60; ++seq) ASSERT_TRUE(send(seq));
  ASSERT_TRUE(results_.wait([](const auto& all) { return !all.empty() && all.back()->seq == 59; })) << "newest wins";
}

TEST_F(SlamServiceTest, asap_pace_publishes_a_result_for_every_frame) {
  start(service::Pace::kAsap);
  constexpr std::uint64_t kInFlight = 3;  // the camera's window
  for (std::uint64_t seq = 0; seq < 60; ++seq) {
    ASSERT_TRUE(seq < kInFlight || results_.wait_count(seq - kInFlight + 1));
    ASSERT_TRUE(send(seq));
  }
  ASSERT_TRUE(results_.wait_count(60));
  for (std::uint64_t seq = 0; seq < 60; ++seq) EXPECT_EQ(results_.all()[seq]->seq, seq);
}

}  // namespace
}  // namespace rtd::slam
