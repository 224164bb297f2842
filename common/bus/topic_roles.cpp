// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topic_roles.hpp"

#include <algorithm>

#include "common/bus/topics.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/services.hpp"

namespace rtd::bus {
namespace {

using Roles = std::vector<std::string_view>;

Roles every_service() {
  Roles names;
  for (const msg::NamedService& service : msg::kServices) names.emplace_back(service.name);
  return names;
}
const Roles kFrameReaders = {"filter", "detector", "dense", "launcher", "viewer"};
/// They read the results; a link also writes them, in the domain of the fleet.
const Roles kOnlookers = {"viewer", "observer", "link"};
/// They may call commands.
const Roles kCallers = {"viewer", "call"};
/// They may be ROS 2 nodes, with what every node opens besides its own topics.
const Roles kRosNodes = {"observer", "call"};

Roles operator+(Roles roles, const Roles& further) {
  roles.insert(roles.end(), further.begin(), further.end());
  return roles;
}

bool has(const Roles& listed, const std::string& role) {
  return std::find(listed.begin(), listed.end(), role) != listed.end();
}

/// A ROS 2 service by its name, or a pattern of names.
void add_service(std::vector<TopicRoles>& roles, const std::string& name, const Roles& servers, const Roles& callers) {
  roles.push_back({"rq/" + name + "Request", callers, servers});
  roles.push_back({"rr/" + name + "Reply", servers, callers});
}

/// With the commands, and with the services of every ROS 2 node, which only it itself calls.
std::vector<TopicRoles> with_services(std::vector<TopicRoles> roles) {
  struct Command {
    const char* name;
    const char* server;
  };
  constexpr Command kCommands[] = {
      {"slam/reset", "slam"},         {"slam/save_map", "slam"},   {"slam/load_map", "slam"},
      {"slam/localize_only", "slam"}, {"slam/ask", "slam"},        {"filter/set_mode", "filter"},
      {"recorder/start", "record"},   {"recorder/stop", "record"}, {"replay/pause", "replay"},
      {"replay/step", "replay"},      {"replay/seek", "replay"},   {"replay/speed", "replay"},
      {"atlas/save", "atlas"},        {"atlas/load", "atlas"},     {"atlas/forget", "atlas"}};
  for (const Command& command : kCommands) add_service(roles, command.name, {command.server}, kCallers);
  for (const char* name : {"describe_parameters", "get_parameter_types", "get_parameters", "list_parameters",
                           "set_parameters", "set_parameters_atomically", "get_type_description"})
    add_service(roles, std::string("*/") + name, kRosNodes, {});
  return roles;
}

}  // namespace

const std::vector<TopicRoles>& topic_roles() {
  using namespace topics;
  static const std::vector<TopicRoles> kRoles = with_services({
      {kFrame.name, {"camera"}, kFrameReaders},
      {kFrame848.name, {"camera"}, kFrameReaders},
      {kFrame1280.name, {"camera"}, kFrameReaders},
      {kFrame1920.name, {"camera"}, kFrameReaders},
      {kColorJpeg.name, {"camera", "link"}, Roles{"detector"} + kOnlookers},
      {kDepthJpeg.name, {"camera"}, kOnlookers},
      {kCameraInfo.name, {"camera", "link"}, kOnlookers},
      {kGroundTruth.name, {"camera"}, kOnlookers},
      {msg::kImuTopic, {"camera"}, Roles{"slam"} + kOnlookers},
      {msg::kWheelTopic, {"camera"}, Roles{"slam"} + kOnlookers},
      {kDetections.name, {"detector", "link"}, Roles{"filter"} + kOnlookers},
      {kPersonMasks.name, {"detector", "link"}, Roles{"filter"} + kOnlookers},
      {kDynamicMask.name, {"filter"}, Roles{"dense"} + kOnlookers},
      {kFeatures.name, {"filter"}, {"slam", "launcher", "viewer"}},
      {kKeyframes.name, {"slam"}, {"filter", "dense", "viewer"}},
      {kTracking.name, {"slam"}, {"camera", "filter", "dense", "detector", "launcher", "viewer"}},
      {kMap.name, {"slam"}, {"viewer", "atlas"}},
      {kKeyframeFeatures.name, {"slam"}, {"atlas"}},
      {kKeyframeRequest.name, {"atlas"}, {"slam"}},
      {kSubmap.name, {"atlas"}, {"slam"}},
      {kAtlas.name, {"atlas"}, Roles{"viewer", "observer"}},
      {kAtlasRobots.name, {"atlas"}, kOnlookers},
      {kAtlasPoints.name, {"atlas"}, kOnlookers},
      {kAtlasFloorPlan.name, {"atlas"}, kOnlookers},
      {kAtlasMapJumps.name, {"atlas"}, kOnlookers},
      {kMovers.name, {"filter"}, Roles{"viewer", "observer"}},
      {kMoverBoxes.name, {"filter"}, kOnlookers},
      {kMoverMarkers.name, {"filter"}, kOnlookers},
      {kStatus.name, every_service(), every_service() + Roles{"launcher", "observer"}},
      {kOdometry.name, {"slam", "link"}, kOnlookers},
      {kPose.name, {"slam", "link"}, kOnlookers},
      {kTf.name, {"slam", "link"}, kOnlookers},
      {kTfStatic.name, {"camera", "atlas"}, {"slam"}},
      {kMapJumps.name, {"slam"}, kOnlookers},
      {kPath.name, {"slam"}, kOnlookers},
      {kMapPoints.name, {"slam"}, kOnlookers},
      {kDensePoints.name, {"dense"}, kOnlookers},
      {kMovingPoints.name, {"dense"}, kOnlookers},
      {kOccupancyGrid.name, {"dense"}, Roles{"atlas"} + kOnlookers},
      {kDiagnostics.name, {"slam"}, kOnlookers},
      // Whatever is recorded can be played again; both work without types.
      {"rtd/*", {"replay"}, {"record", "replay", "topics"}},
      {"rt/*", {"replay"}, {"record", "replay", "topics"}},
      // What every ROS 2 node opens besides its own topics.
      {"ros_discovery_info", kRosNodes, kRosNodes},
      {"rt/rosout", kRosNodes, {}},
      {"rt/parameter_events", kRosNodes, kRosNodes},
  });
  return kRoles;
}

const std::vector<std::string>& roles() {
  static const std::vector<std::string> kRoles = [] {
    std::vector<std::string> names = msg::service_names();
    names.insert(names.end(), {"launcher", "topics", "observer", "call"});
    return names;
  }();
  return kRoles;
}

RoleTopics topics_of(const std::string& role) {
  RoleTopics topics;
  for (const TopicRoles& entry : topic_roles()) {
    if (has(entry.writers, role)) topics.writes.push_back(entry.topic);
    if (has(entry.readers, role)) topics.reads.push_back(entry.topic);
  }
  return topics;
}

}  // namespace rtd::bus
