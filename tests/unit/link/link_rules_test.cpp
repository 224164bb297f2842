// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/link/core/link_rules.hpp"

#include <gmock/gmock.h>

#include "common/bus/frame_topics.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/bus/robot.hpp"

namespace rtd::link {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr Direction kOut = Direction::kToFleet, kIn = Direction::kToRobot;

std::vector<std::byte> heartbeat_of(const std::string& service) {
  msg::ServiceStatus status;
  status.service = service;
  std::vector<std::byte> cdr(bus::cdr_size(status));
  bus::write_cdr(status, {reinterpret_cast<std::uint8_t*>(cdr.data()), cdr.size()});
  return cdr;
}

TEST(LinkRules, by_default_images_and_poses_go_out_and_detections_come_in) {
  const LinkRules rules("anna", default_rules());
  for (const char* topic : {"rt/anna/camera/color/image_raw/compressed", "rt/anna/camera/color/camera_info",
                            "rt/anna/slam/pose", "rt/anna/slam/odometry", "rt/tf", "rtd/anna/status"}) {
    EXPECT_TRUE(rules.allows(kOut, topic)) << topic;
  }
  for (const char* topic :
       {"rt/anna/detector/detections", "rtd/anna/keyframes", "rt/anna/slam/map_points", "rt/rosout"})
    EXPECT_FALSE(rules.allows(kOut, topic)) << topic;
  EXPECT_TRUE(rules.allows(kIn, "rt/anna/detector/detections"));
  EXPECT_TRUE(rules.allows(kIn, "rt/anna/detector/masks"));
  EXPECT_TRUE(rules.allows(kIn, "rtd/anna/status"));
  for (const char* topic : {"rt/tf", "rt/anna/slam/pose", "rt/anna/camera/color/image_raw/compressed"})
    EXPECT_FALSE(rules.allows(kIn, topic)) << topic;
}

TEST(LinkRules, topics_of_other_robots_never_pass) {
  const LinkRules rules("anna", {"*", "in:*"});
  for (const Direction direction : {kOut, kIn}) {
    EXPECT_TRUE(rules.allows(direction, "rt/anna/slam/map_points"));
    EXPECT_TRUE(rules.allows(direction, "rt/joy"));
    EXPECT_FALSE(rules.allows(direction, "rt/bert/slam/pose"));
    EXPECT_FALSE(rules.allows(direction, "rtd/bert/status"));
  }
}

TEST(LinkRules, raw_frames_and_features_never_pass) {
  const LinkRules all("anna", {"*"});
  for (const bus::FrameTopic& frame : bus::frame_topics())
    EXPECT_FALSE(all.allows(kOut, bus::topic_of_robot(frame.name, "anna"))) << frame.name;
  EXPECT_FALSE(all.allows(kOut, "rtd/anna/features"));
  EXPECT_THAT([] { LinkRules("anna", {"rtd/anna/frame"}); },
              ThrowsMessage<RuleError>(HasSubstr("never leave their host")));
  EXPECT_THAT([] { LinkRules("anna", {"in:"}); }, ThrowsMessage<RuleError>(HasSubstr("name a topic")));
}

TEST(LinkRules, patterns_take_every_spelling_of_a_name) {
  for (const char* pattern : {"/slam/map_points", "rt/slam/map_points", "/anna/slam/*", "rt/anna/slam/map_points"})
    EXPECT_TRUE(LinkRules("anna", {pattern}).allows(kOut, "rt/anna/slam/map_points")) << pattern;
  EXPECT_TRUE(LinkRules("anna", {"in:/goal"}).allows(kIn, "rt/goal"));
  EXPECT_FALSE(LinkRules("anna", {"in:/goal"}).allows(kOut, "rt/goal"));
}

TEST(LinkRules, a_robot_gets_only_the_heartbeats_of_its_detector_and_of_other_links) {
  const LinkRules rules("anna", default_rules());
  for (const char* service : {"camera", "slam", "filter"}) {
    EXPECT_TRUE(rules.passes(kOut, "rtd/anna/status", heartbeat_of(service))) << service;
    EXPECT_FALSE(rules.passes(kIn, "rtd/anna/status", heartbeat_of(service))) << service;
  }
  EXPECT_TRUE(rules.passes(kIn, "rtd/anna/status", heartbeat_of("detector")));
  EXPECT_TRUE(rules.passes(kIn, "rtd/anna/status", heartbeat_of("link")));
  const std::vector<std::byte> garbage(7, std::byte{0xff});
  EXPECT_FALSE(rules.passes(kIn, "rtd/anna/status", garbage));
  EXPECT_TRUE(rules.passes(kIn, "rt/anna/detector/detections", garbage)) << "other topics are bytes";
}

}  // namespace
}  // namespace rtd::link
