// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

/// Several robots in one domain: a robot with a name has its own topics and tf frames. Without a name ("") both are as
/// written in topics.hpp and the configuration.
namespace rtd::bus {

inline constexpr std::size_t kLongestRobotName = 32;

/// Where ROS 2 programs announce their nodes (common/bus/ros_graph.hpp).
inline constexpr std::string_view kRosGraphTopic = "ros_discovery_info";

/// What ROS 2 takes as one part of a topic's name: letters, digits and single underscores, a letter first, at most
/// kLongestRobotName. "" is no name.
bool is_robot_name(std::string_view name);

/// Throws BusError for a text that is neither "" nor a robot's name.
void require_robot_name(const std::string& name);

/// "rt/slam/odometry" of robot "anna": "rt/anna/slam/odometry". What all robots share keeps its name: "rt/tf",
/// "rt/diagnostics", those of the atlas and the topics of ROS 2 itself.
std::string topic_of_robot(std::string_view topic, std::string_view robot);

/// A name on the wire, divided.
struct RobotTopic {
  std::string robot;  ///< "": of a robot without a name, or shared by all
  std::string topic;  ///< as in topics.hpp
  bool operator==(const RobotTopic&) const = default;
};
/// Whether a topic carries no data of a program: the two of a ROS 2 service ("rq/...", "rr/...") and the list of nodes.
bool is_internal_to_ros(std::string_view wire_name);
/// The service that answers on this topic: "anna/slam/reset" of "rr/anna/slam/resetReply"; "" for other topics.
std::string_view service_of_reply(std::string_view wire_name);

/// The inverse of topic_of_robot() for the topics of topics.hpp and those next to them in the same ROS namespaces
/// ("rt/slam/..."); other names belong to no robot.
RobotTopic split_robot(std::string_view wire_name);

/// Whether a robot may take a topic as its own or as shared by all: all but those of other robots.
bool concerns_robot(std::string_view wire_name, std::string_view robot);

/// The named robots that have topics among these.
std::set<std::string> robots_in(const std::vector<std::string>& wire_names);

/// "odom" of robot "anna": "anna/odom".
std::string frame_of_robot(const std::string& frame, std::string_view robot);

/// Whose keys a role ("slam") of a robot uses: "/rtd/slam", "/rtd/anna/slam".
std::string enclave_of_robot(const std::string& role, std::string_view robot);

}  // namespace rtd::bus
