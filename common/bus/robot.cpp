// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/robot.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "common/bus/backend.hpp"

namespace rtd::bus {
namespace {

constexpr std::string_view kOwn = "rtd/", kRos = "rt/", kRequest = "rq/", kReply = "rr/";

/// First parts of the names below "rt/" that belong to one robot.
constexpr std::array<std::string_view, 5> kNodes = {"camera/", "detector/", "filter/", "slam/", "dense/"};

/// The floor plan, where a map server of ROS 2 has its own.
constexpr std::string_view kPlan = "map";

/// What the atlas says of all robots.
constexpr std::string_view kAllRobots = "atlas";

/// Those that only commands have.
constexpr std::array<std::string_view, 2> kCommandNodes = {"recorder/", "replay/"};

bool begins_with_one(std::string_view name, const auto& nodes) {
  return std::ranges::any_of(nodes, [name](std::string_view node) { return name.starts_with(node); });
}

/// The part of DDS names that this one begins with; "" for others.
std::string_view kind_of(std::string_view topic) {
  for (const std::string_view kind : {kOwn, kRos, kRequest, kReply}) {
    if (topic.starts_with(kind)) return kind;
  }
  return "";
}

/// Whether a robot has its own topic of that kind and name.
bool is_own(std::string_view kind, std::string_view name) {
  if (kind == kOwn) return name != kAllRobots;
  return begins_with_one(name, kNodes) || (kind == kRos ? name == kPlan : begins_with_one(name, kCommandNodes));
}

/// The prefix of a topic that belongs to one robot; "" for others.
std::string_view prefix_of(std::string_view topic) {
  const std::string_view kind = kind_of(topic);
  return !kind.empty() && is_own(kind, topic.substr(kind.size())) ? kind : "";
}

}  // namespace

bool is_robot_name(std::string_view name) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !name.empty() && name.size() <= kLongestRobotName && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
         std::ranges::all_of(name, fits) && name.find("__") == std::string_view::npos;
}

void require_robot_name(const std::string& name) {
  if (name.empty() || is_robot_name(name)) return;
  throw BusError("'" + name +
                 "' cannot be a robot's name: use letters, digits and single underscores, a letter first, at most " +
                 std::to_string(kLongestRobotName) + " (--robot)");
}

std::string topic_of_robot(std::string_view topic, std::string_view robot) {
  const std::string_view prefix = prefix_of(topic);
  if (robot.empty() || prefix.empty()) return std::string(topic);
  return std::string(prefix).append(robot).append("/").append(topic.substr(prefix.size()));
}

bool is_internal_to_ros(std::string_view wire_name) {
  return wire_name.starts_with(kRequest) || wire_name.starts_with(kReply) || wire_name == kRosGraphTopic;
}

std::string_view service_of_reply(std::string_view wire_name) {
  constexpr std::string_view kEnd = "Reply";
  if (!wire_name.starts_with(kReply) || !wire_name.ends_with(kEnd) || wire_name.size() <= kReply.size() + kEnd.size())
    return {};
  return wire_name.substr(kReply.size(), wire_name.size() - kReply.size() - kEnd.size());
}

RobotTopic split_robot(std::string_view wire_name) {
  const RobotTopic unnamed{{}, std::string(wire_name)};
  const std::string_view prefix = kind_of(wire_name);
  const std::string_view name = wire_name.substr(prefix.size());
  const std::size_t slash = name.find('/');
  if (prefix.empty() || slash == std::string_view::npos) return unnamed;
  const std::string_view robot = name.substr(0, slash), rest = name.substr(slash + 1);
  if (!is_robot_name(robot) || rest.empty() || !is_own(prefix, rest)) return unnamed;
  return {std::string(robot), std::string(prefix).append(rest)};
}

bool concerns_robot(std::string_view wire_name, std::string_view robot) {
  const std::string owner = split_robot(wire_name).robot;
  return owner.empty() || owner == robot;
}

std::set<std::string> robots_in(const std::vector<std::string>& wire_names) {
  std::set<std::string> robots;
  for (const std::string& name : wire_names) robots.insert(split_robot(name).robot);
  robots.erase("");
  return robots;
}

std::string frame_of_robot(const std::string& frame, std::string_view robot) {
  return robot.empty() ? frame : std::string(robot) + "/" + frame;
}

std::string enclave_of_robot(const std::string& role, std::string_view robot) {
  return "/rtd/" + frame_of_robot(role, robot);
}

}  // namespace rtd::bus
