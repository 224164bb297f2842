// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <thread>

#include "common/service/bus_config.hpp"
#include "common/service/camera_frame.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::service {
namespace {

using namespace ::testing;

class DdsEnvironment : public ::testing::Test {
 protected:
  DdsEnvironment() { options_.vendor = "fastdds"; }
  /// The only setting.
  DdsSetting follow(const std::string& name, const std::string& value) {
    const std::map<std::string, std::string> set = {{name, value}};
    const auto settings = follow_dds_environment(
        [&](const std::string& asked) {
          const auto found = set.find(asked);
          return found == set.end() ? std::nullopt : std::optional(found->second);
        },
        options_);
    EXPECT_EQ(settings.size(), 1U);
    return settings.empty() ? DdsSetting{} : settings.front();
  }
  bus::BusOptions options_;
};

TEST_F(DdsEnvironment, nothing_set_is_nothing_said) {
  EXPECT_THAT(follow_dds_environment([](const std::string&) { return std::nullopt; }, options_), IsEmpty());
}

TEST_F(DdsEnvironment, a_discovery_server_is_followed_where_it_can_be_reached) {
  EXPECT_TRUE(follow("ROS_DISCOVERY_SERVER", "127.0.0.1").followed);
  EXPECT_EQ(options_.network.discovery_server, "127.0.0.1:11811");

  options_.network.discovery_server.clear();
  const DdsSetting outside = follow("ROS_DISCOVERY_SERVER", "192.168.1.5:11888");
  EXPECT_FALSE(outside.followed);
  EXPECT_THAT(outside.text, AllOf(HasSubstr("ROS_DISCOVERY_SERVER=192.168.1.5:11888"), HasSubstr("--profile lan")));
  EXPECT_EQ(options_.network.discovery_server, "");

  options_.network.loopback_only = false;
  EXPECT_TRUE(follow("ROS_DISCOVERY_SERVER", "192.168.1.5:11888").followed);
  EXPECT_EQ(options_.network.discovery_server, "192.168.1.5:11888");
  EXPECT_THAT(follow("ROS_DISCOVERY_SERVER", "10.0.0.1:1").text, HasSubstr("192.168.1.5:11888 is used instead"));
}

TEST_F(DdsEnvironment, servers_that_cannot_be_used_are_named) {
  options_.network.loopback_only = false;
  EXPECT_THAT(follow("ROS_DISCOVERY_SERVER", "10.0.0.1:1;10.0.0.2:1").text, HasSubstr("one server with id 0"));
  EXPECT_THAT(follow("ROS_DISCOVERY_SERVER", ";10.0.0.2:1").text, HasSubstr("one server with id 0"));
  EXPECT_THAT(follow("ROS_DISCOVERY_SERVER", "TCPv4:[10.0.0.2]:1").text, HasSubstr("UDP over IPv4"));
  options_.vendor = "cyclonedds";
  EXPECT_THAT(follow("ROS_DISCOVERY_SERVER", "10.0.0.1:1").text, HasSubstr("--dds fastdds"));
  EXPECT_EQ(options_.network.discovery_server, "");
}

TEST_F(DdsEnvironment, static_peers_are_followed_on_a_network) {
  EXPECT_THAT(follow("ROS_STATIC_PEERS", "192.168.1.5").text, HasSubstr("--profile lan"));
  EXPECT_THAT(options_.network.peers, IsEmpty());
  options_.network.loopback_only = false;
  EXPECT_TRUE(follow("ROS_STATIC_PEERS", "192.168.1.5; gpubox;").followed);
  EXPECT_THAT(options_.network.peers, ElementsAre("192.168.1.5", "gpubox"));
}

TEST_F(DdsEnvironment, profiles_are_named_with_the_options_in_their_place) {
  options_.vendor = "cyclonedds";
  const DdsSetting text =
      follow("CYCLONEDDS_URI",
             R"(<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="eth0"/></Interfaces></General>)"
             R"(<Discovery><Peers><Peer address="10.0.0.7"/><Peer Address="10.0.0.8"/></Peers></Discovery>)"
             R"(</Domain></CycloneDDS>)");
  EXPECT_FALSE(text.followed);
  EXPECT_THAT(text.text, AllOf(HasSubstr("CYCLONEDDS_URI"), HasSubstr("--peers 10.0.0.7,10.0.0.8"),
                               HasSubstr("--interface eth0")));
  EXPECT_THAT(follow("CYCLONEDDS_URI", "file:///no/such.xml").text, HasSubstr("no such file"));
}

TEST_F(DdsEnvironment, profiles_of_the_other_vendor_do_not_matter) {
  EXPECT_THAT(follow_dds_environment(
                  [](const std::string& name) {
                    return name == "CYCLONEDDS_URI" ? std::optional<std::string>("/a.xml") : std::nullopt;
                  },
                  options_),
              IsEmpty());
}

TEST_F(DdsEnvironment, a_range_that_differs_is_named) {
  EXPECT_TRUE(follow("ROS_LOCALHOST_ONLY", "1").followed);
  EXPECT_THAT(follow("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET").text, HasSubstr("--profile lan or wifi uses it, too"));
  EXPECT_THAT(follow("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF").text, HasSubstr("find no other one, rtd neither"));
  options_.network.loopback_only = false;
  EXPECT_TRUE(follow("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET").followed);
  EXPECT_THAT(follow("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST").text, HasSubstr("rtd uses the network"));
}

std::string form_with(const char* distribution, const std::string& setting) {
  ::setenv("ROS_DISTRO", distribution, 1);
  BusConfig config;
  config.options.ros_graph = setting;
  const std::string form = to_bus_options(config, "rtd-slam").ros_graph;
  ::unsetenv("ROS_DISTRO");
  return form;
}

TEST(RosGraphSetting, follows_the_distribution_unless_given) {
  EXPECT_EQ(form_with("humble", "auto"), "humble");
  EXPECT_EQ(form_with("galactic", "auto"), "humble");
  for (const char* newer : {"iron", "jazzy", "rolling", ""}) EXPECT_EQ(form_with(newer, "auto"), "iron");
  EXPECT_EQ(form_with("humble", "iron"), "iron");
  EXPECT_EQ(form_with("humble", "off"), "off");
}

constexpr const char* kUsual = "camera_color_optical_frame";

class CameraFrame : public testing::Test {
 protected:
  static std::shared_ptr<bus::Bus> join() {
    bus::BusOptions options;
    options.vendor = bus::inprocess::vendor();
    options.robot = "anna";
    return bus::connect(options);
  }
  bool wait_known() const {
    for (int i = 0; i < 1000 && !knows_camera_frame(slam_); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return knows_camera_frame(slam_);
  }

  StopToken stop_;
  const std::shared_ptr<bus::Bus> of_slam_ = join(), of_camera_ = join();
  Heartbeat slam_{*of_slam_, "slam", stop_}, camera_{*of_camera_, "camera", stop_};
};

TEST_F(CameraFrame, is_the_usual_one_of_the_robot_until_a_camera_names_it) {
  EXPECT_FALSE(knows_camera_frame(slam_));
  EXPECT_EQ(camera_frame(slam_, *of_slam_), std::string("anna/") + kUsual);
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, "astra_rgb_optical_frame"), "astra_rgb_optical_frame");
  ASSERT_TRUE(wait_known());
  EXPECT_EQ(camera_frame(slam_, *of_slam_), "astra_rgb_optical_frame") << "as its driver has it in tf";
  EXPECT_EQ(camera_frame(slam_, *of_slam_, "lens"), "anna/lens") << "the setting wins";
}

TEST_F(CameraFrame, that_a_heartbeat_cannot_carry_becomes_the_usual_one) {
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, "my camera"), std::string("anna/") + kUsual);
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, ""), std::string("anna/") + kUsual);
  EXPECT_EQ(announce_camera_frame(camera_, *of_camera_, std::string(300, 'x')), std::string("anna/") + kUsual);
}

}  // namespace
}  // namespace rtd::service
