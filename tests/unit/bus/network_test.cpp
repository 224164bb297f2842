// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/bus/backend.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/bus/network.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topic_roles.hpp"
#include "common/bus/topics.hpp"

namespace rtd::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Robot, without_a_name_all_topics_and_frames_keep_theirs) {
  for (const TopicRoles& entry : topic_roles()) {
    EXPECT_EQ(topic_of_robot(entry.topic, ""), entry.topic);
    EXPECT_EQ(split_robot(entry.topic), (RobotTopic{"", entry.topic}));
  }
  EXPECT_EQ(frame_of_robot("odom", ""), "odom");
}

TEST(Robot, with_a_name_topics_and_frames_are_below_it) {
  EXPECT_EQ(topic_of_robot("rtd/frame", "anna"), "rtd/anna/frame");
  EXPECT_EQ(topic_of_robot("rt/slam/odometry", "anna"), "rt/anna/slam/odometry");
  EXPECT_EQ(topic_of_robot("rt/camera/color/image_raw/compressed", "b_2"), "rt/b_2/camera/color/image_raw/compressed");
  EXPECT_EQ(topic_of_robot("rt/map", "anna"), "rt/anna/map");
  EXPECT_EQ(topic_of_robot("rt/map_server/plan", "anna"), "rt/map_server/plan");
  EXPECT_EQ(frame_of_robot("odom", "anna"), "anna/odom");
}

TEST(Robot, what_all_robots_share_keeps_its_name) {
  for (const char* topic :
       {"rt/tf", "rt/tf_static", "rt/diagnostics", "rt/rosout", "ros_discovery_info", "rq/a/bRequest", "rtd/atlas"})
    EXPECT_EQ(topic_of_robot(topic, "anna"), topic);
}

TEST(Robot, a_name_on_the_wire_is_divided_again) {
  for (const TopicRoles& entry : topic_roles()) {
    if (entry.topic.ends_with('*')) continue;
    const std::string wire = topic_of_robot(entry.topic, "camera");  // also a robot with the name of a node
    const std::string robot = wire == entry.topic ? "" : "camera";
    EXPECT_EQ(split_robot(wire), (RobotTopic{robot, entry.topic}));
  }
  EXPECT_EQ(split_robot("rt/anna/arm/joints"), (RobotTopic{"", "rt/anna/arm/joints"})) << "not one of ours";
  EXPECT_EQ(split_robot("rt/2d/slam/pose"), (RobotTopic{"", "rt/2d/slam/pose"})) << "no robot has such a name";
  EXPECT_EQ(split_robot("rtd/"), (RobotTopic{"", "rtd/"}));
  EXPECT_EQ(split_robot("rtd/anna/"), (RobotTopic{"", "rtd/anna/"}));
}

TEST(Robot, a_robot_is_not_concerned_by_the_topics_of_others) {
  EXPECT_TRUE(concerns_robot("rt/anna/slam/pose", "anna"));
  EXPECT_TRUE(concerns_robot("rt/tf", "anna"));
  EXPECT_FALSE(concerns_robot("rt/bert/slam/pose", "anna"));
  EXPECT_EQ(robots_in({"rt/anna/slam/pose", "rtd/bert/frame", "rtd/frame", "rt/tf"}),
            (std::set<std::string>{"anna", "bert"}));
}

TEST(Robot, names_are_those_of_ros) {
  for (const char* name : {"a", "Anna", "robot_1", "x2"}) EXPECT_TRUE(is_robot_name(name)) << name;
  const std::string long_name(kLongestRobotName + 1, 'a');
  for (const char* name : {"", "1st", "_a", "a b", "a/b", "a__b", "b\xc3\xa4r", "a*", long_name.c_str()})
    EXPECT_FALSE(is_robot_name(name)) << name;
  EXPECT_NO_THROW(require_robot_name(""));
  EXPECT_THROW(require_robot_name("a/b"), BusError);
}

TEST(Robot, raw_frames_and_features_of_a_robot_stay_on_its_host) {
  EXPECT_TRUE(stays_on_host("rtd/anna/frame_1280x720"));
  EXPECT_TRUE(stays_on_host("rtd/anna/features"));
  EXPECT_FALSE(stays_on_host("rtd/anna/keyframes"));
  EXPECT_FALSE(stays_on_host("rt/anna/camera/color/image_raw/compressed"));
}

/// What() of the BusError that `call` throws; empty when it throws none.
template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const BusError& error) {
    return error.what();
  }
  return {};
}

BusOptions with_peers(std::vector<std::string> peers) {
  BusOptions options;
  options.network.peers = std::move(peers);
  return options;
}

TEST(Network, a_host_is_an_address_or_a_name_with_or_without_port) {
  EXPECT_EQ(resolve_host("10.0.0.2", "--peers"), (HostAddress{"10.0.0.2", 0}));
  EXPECT_EQ(resolve_host("10.0.0.2:7412", "--peers"), (HostAddress{"10.0.0.2", 7412}));
  EXPECT_EQ(resolve_host("localhost", "--peers"), (HostAddress{"127.0.0.1", 0}));
}

TEST(Network, a_host_that_cannot_be_is_named_with_the_option) {
  for (const std::string text :
       {"10.0.0.2:0", "10.0.0.2:70000", "10.0.0.2:x", "10.0.0.2:", ":7400", "", "no such host"})
    EXPECT_THAT(refusal([&] { resolve_host(text, "--peers"); }), HasSubstr("--peers " + text)) << text;
}

TEST(Network, loopback_alone_has_no_further_addresses) {
  EXPECT_THAT(interface_addresses({}), IsEmpty());
}

TEST(Network, an_unknown_interface_is_refused_with_the_known_ones) {
  NetworkOptions network;
  network.loopback_only = false;
  network.interfaces = {"eth99"};
  EXPECT_THAT(refusal([&] { interface_addresses(network); }), AllOf(HasSubstr("eth99"), HasSubstr("there are")));
}

TEST(Network, peers_elsewhere_need_a_network_profile) {
  EXPECT_THAT(refusal([] { require_network(with_peers({"10.0.0.2"})); }), HasSubstr("--profile lan"));
  EXPECT_THAT(refusal([] { require_network(with_peers({"127.0.0.1"})); }), IsEmpty());
}

TEST(Network, a_discovery_server_is_for_fast_dds_and_has_a_port) {
  BusOptions options;
  options.network.discovery_server = "127.0.0.1";
  EXPECT_THAT(refusal([&] { require_network(options); }), HasSubstr("HOST:PORT"));
  options.network.discovery_server = "127.0.0.1:11811";
  EXPECT_THAT(refusal([&] { require_network(options); }), IsEmpty());
  options.vendor = "cyclonedds";
  EXPECT_THAT(refusal([&] { require_network(options); }), HasSubstr("--peers"));
}

TEST(Network, raw_frames_and_features_stay_on_the_host) {
  for (const FrameTopic& frame : frame_topics()) EXPECT_TRUE(stays_on_host(frame.name)) << frame.name;
  EXPECT_TRUE(stays_on_host(topics::kFeatures.name));
  EXPECT_FALSE(stays_on_host(topics::kColorJpeg.name));
  EXPECT_FALSE(stays_on_host(topics::kDetections.name));
}

TEST(Network, the_partition_of_a_host_is_always_the_same) {
  EXPECT_EQ(host_partition(), host_partition());
  EXPECT_THAT(host_partition(), HasSubstr("host-"));
}

}  // namespace
}  // namespace rtd::bus
