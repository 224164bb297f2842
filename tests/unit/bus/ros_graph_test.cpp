// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/ros_graph.hpp"

#include <gtest/gtest.h>

#include "common/bus/command_registry.hpp"
#include "common/bus/robot.hpp"

namespace rtd::bus {
namespace {

using Direction = NodeEndpoints::Direction;

WriterId id_of(std::uint8_t number) {
  WriterId id{};
  id.back() = number;
  return id;
}

TEST(NodeName, follows_connection_and_robot) {
  EXPECT_EQ(node_name("rtd-slam", "").space, "/");
  EXPECT_EQ(node_name("rtd-slam", "").name, "rtd_slam");
  EXPECT_EQ(node_name("rtd-slam", "anna").space, "/anna");
  EXPECT_EQ(node_name("", "").name, "rtd");
}

TEST(RosGraphMessage, has_identities_of_the_size_of_its_distribution) {
  const NodeName node{"/", "rtd_slam"};
  const std::set<WriterId> none, one = {id_of(1)}, two = {id_of(2), id_of(3)};
  const auto size = [&](RosGraph form, const auto& readers, const auto& writers) {
    return graph_message(form, id_of(9), node, readers, writers).size();
  };
  EXPECT_EQ(size(RosGraph::kIron, one, two) - size(RosGraph::kIron, none, none), 3 * 16U);
  EXPECT_EQ(size(RosGraph::kHumble, one, two) - size(RosGraph::kHumble, none, none), 3 * 24U);
  EXPECT_EQ(size(RosGraph::kHumble, none, none) - size(RosGraph::kIron, none, none), 8U);
}

TEST(RosGraphForm, is_iron_unless_said_otherwise) {
  BusOptions options;
  EXPECT_EQ(ros_graph_of(options), RosGraph::kIron);
  options.ros_graph = "humble";
  EXPECT_EQ(ros_graph_of(options), RosGraph::kHumble);
  options.ros_graph = "off";
  EXPECT_EQ(ros_graph_of(options), RosGraph::kOff);
}

TEST(NodeEndpoints, are_those_that_live) {
  NodeEndpoints endpoints;
  std::size_t changes = 0, readers = 0, writers = 0;
  const NodeEndpoints::Entry before(endpoints, "rtd/status", id_of(1), Direction::kWrites);
  endpoints.watch([&](const auto& reading, const auto& writing) {
    ++changes;
    readers = reading.size();
    writers = writing.size();
  });
  EXPECT_EQ(writers, 1U) << "what was there before";
  {
    const NodeEndpoints::Entry reader(endpoints, "rt/tf", id_of(2), Direction::kReads);
    EXPECT_EQ(readers, 1U);
    const NodeEndpoints::Entry own(endpoints, std::string(kRosGraphTopic), id_of(3), Direction::kWrites);
    EXPECT_EQ(writers, 1U) << "the list itself belongs to no node";
  }
  EXPECT_EQ(readers, 0U);
  EXPECT_EQ(changes, 3U);
  endpoints.watch(nullptr);
}

TEST(CommandRegistry, calls_what_is_offered_and_answers_what_it_throws) {
  CommandRegistry book;
  EXPECT_FALSE(book.call("slam/reset", {}).has_value());
  book.add("slam/reset", [](const CommandRequest& request) -> CommandAnswer {
    if (request.argument == "bad") throw std::runtime_error("cause and fix");
    return {true, "got " + request.argument};
  });
  EXPECT_EQ(book.call("slam/reset", {"x"})->message, "got x");
  EXPECT_EQ(book.call("slam/reset", {"bad"})->message, "cause and fix");
  EXPECT_FALSE(book.call("slam/reset", {"bad"})->success);
  book.remove("slam/reset");
  EXPECT_FALSE(book.call("slam/reset", {"x"}).has_value());
}

}  // namespace
}  // namespace rtd::bus
