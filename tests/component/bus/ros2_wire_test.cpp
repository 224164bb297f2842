// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What a ROS 2 node sees of our topics in discovery, and that its usual subscriptions are served.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "common/bus/command_codec.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/ros2/names.hpp"
#include "common/ros2/type_description.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/ros_double.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

class Ros2Wire : public ::testing::TestWithParam<std::string> {
 protected:
  static BusOptions options(const char* name) { return options_of(GetParam(), name); }
};

void expect_as_ros2_wants_it(const TopicWriter& writer, bool latched) {
  EXPECT_NE(ros2::ros_type(writer.topic.type), writer.topic.type) << "is a ROS 2 name: " << writer.topic.type;
  EXPECT_EQ(ros2::ros_topic(writer.topic.name).substr(0, 1), "/") << writer.topic.name;
  EXPECT_FALSE(writer.topic.keyed);
  EXPECT_EQ(ros2::hash_in(writer.user_data), ros2::type_hash(writer.topic.type));
  EXPECT_NE(ros2::type_hash(writer.topic.type), "") << writer.topic.type;
  const RawQos& qos = writer.qos;
  EXPECT_TRUE(qos.reliable);
  EXPECT_EQ(qos.durability, latched ? RawQos::Durability::kTransientLocal : RawQos::Durability::kVolatile);
  EXPECT_EQ(qos.deadline_ns, kUnlimitedNs);
  EXPECT_EQ(qos.lifespan_ns, kUnlimitedNs);
  EXPECT_EQ(qos.liveliness, RawQos::Liveliness::kAutomatic);
  EXPECT_EQ(qos.liveliness_lease_ns, kUnlimitedNs);
}

TEST_P(Ros2Wire, topics_of_standard_types_announce_names_qos_and_hashes_of_ros2) {
  const auto bus = connect(options("ros2-wire-typed"));
  const auto raw = connect_raw(options("ros2-wire-raw"));
  const auto check = [&](const auto& topic) {
    const auto writer = bus->writer(topic);
    expect_as_ros2_wants_it(discovered_writer(*raw, topic.name), topic.profile == QosProfile::kLatched);
  };
  using namespace topics;
  check(kColorJpeg);
  check(kDepthJpeg);
  check(kCameraInfo);
  check(kDetections);
  check(kPersonMasks);
  check(kDynamicMask);
  check(kOdometry);
  check(kPose);
  check(kTf);
  check(kMapJumps);
  check(kPath);
  check(kMapPoints);
  check(kDensePoints);
  check(kMovingPoints);
  check(kDiagnostics);
  check(kOccupancyGrid);
}

TEST_P(Ros2Wire, default_and_sensor_data_subscriptions_are_served) {
  const auto bus = connect(options("ros2-wire-typed"));
  const auto raw = connect_raw(options("ros2-wire-raw"));
  auto writer = bus->writer(topics::kOdometry);
  Collector<RawSample> reliable, best_effort;
  const RawTopic topic{"rt/slam/odometry", "nav_msgs::msg::dds_::Odometry_"};
  RawReaderOptions by_default, sensor_data;
  by_default.depth = 10;
  sensor_data.depth = 5;
  sensor_data.reliable = false;
  const auto first = raw->reader(topic, by_default, into(reliable));
  const auto second = raw->reader(topic, sensor_data, into(best_effort));
  for (int i = 0; i < 10000 && (writer.matched() < 2 || first->matched() + second->matched() < 2); ++i) {
    std::this_thread::sleep_for(1ms);
  }
  ASSERT_EQ(writer.matched(), 2);
  for (int i = 0; i < 20; ++i) {  // best effort: one of them may get lost
    writer.write(msg::Odometry{});
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_NE(reliable.next(), nullptr);
  EXPECT_NE(best_effort.next(), nullptr);
}

TEST_P(Ros2Wire, a_connection_is_a_node_that_follows_its_endpoints) {
  using rtd::testing::RosDouble;
  for (const std::string& other : dds_vendors()) {
    BusOptions watching = options("ros2-wire-ros");
    watching.vendor = other;
    RosDouble ros(watching);
    BusOptions own = options("rtd-slam");
    own.robot = "anna";
    auto bus = connect(own);
    const auto second = connect(own);
    auto pose = bus->writer(topics::kPose);
    auto detections = bus->reader(topics::kDetections, [](const auto&) {});
    const auto reads = [&] { return ros.read_by("/anna/rtd_slam"); };
    const auto writes = [&] { return ros.written_by("/anna/rtd_slam"); };
    const std::set<std::string> pose_only{"rt/anna/slam/pose"}, detections_only{"rt/anna/detector/detections"};
    EXPECT_TRUE(test_support::eventually([&] { return writes() == pose_only && reads() == detections_only; }));
    EXPECT_TRUE(test_support::eventually([&] { return ros.nodes().contains("/anna/rtd_slam_2"); }))
        << "names are unique";
    detections = {};
    EXPECT_TRUE(test_support::eventually([&] { return reads().empty(); }));
    EXPECT_EQ(writes(), pose_only);
    // With Cyclone DDS a service is one of a second participant, on Fast DDS.
    const CommandServer server(*bus, "slam/reset", CommandKind::kTrigger, [](const auto&) { return CommandAnswer{}; });
    EXPECT_TRUE(
        test_support::eventually([&] { return reads() == std::set<std::string>{"rq/anna/slam/resetRequest"}; }));
    EXPECT_TRUE(test_support::eventually([&] { return writes().contains("rr/anna/slam/resetReply"); }));
    EXPECT_FALSE(ros.nodes().contains("/anna/rtd_slam_3"));
    EXPECT_EQ(ros.warnings(), std::vector<std::string>());
  }
}

TEST_P(Ros2Wire, no_program_of_ros2_warns_of_an_endpoint) {
  const auto bus = connect(options("ros2-wire-typed"));
  rtd::testing::RosDouble ros(options("ros2-wire-ros"));
  const auto frames = bus->writer(topics::kFrame);
  const auto tracking = bus->reader(topics::kTracking, [](const auto&) {});
  const CommandServer server(*bus, "slam/save_map", CommandKind::kText, [](const auto&) { return CommandAnswer{}; });
  const auto raw = connect_raw(options("ros2-wire-raw"));
  const auto unknown = raw->writer({"rt/unknown", "unknown_msgs::msg::dds_::Thing_"}, {});
  const auto client = raw->create_calls(call_topics("slam/save_map", CommandKind::kText), CallRole::kClient,
                                        [](const CallId&, std::span<const std::byte>) {});
  EXPECT_TRUE(test_support::eventually([&] { return ros.endpoints() >= 10; })) << ros.endpoints();
  EXPECT_EQ(ros.warnings(), std::vector<std::string>());
}

INSTANTIATE_TEST_SUITE_P(EachVendor, Ros2Wire, ::testing::ValuesIn(dds_vendors()),
                         [](const auto& vendor) { return vendor.param; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Ros2Wire);

}  // namespace
}  // namespace rtd::bus
