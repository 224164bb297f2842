// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

/// Which topics pass between a robot's own DDS domain and the domain of the fleet. No DDS, no clock.
namespace rtd::link {

enum class Direction { kToFleet, kToRobot };

/// A rule that cannot be; what() names it and the fix.
class RuleError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What passes unless rules are given: images for the detector, poses, and its detections back.
const std::vector<std::string>& default_rules();

/// The rules of one robot. A rule is a shell pattern of topics in the spelling of ROS 2 or DDS, with or without the
/// name of the robot ("/slam/pose", "rt/anna/slam/*"), from the robot to the fleet; with "in:" in front ("in:/goal")
/// from the fleet to the robot. Only topics of this robot pass and those that all robots share. Heartbeats
/// ("rtd/NAME/status") always pass, see passes(). Immutable.
class LinkRules {
 public:
  /// Throws RuleError: an empty rule, raw frames or features, which never leave their host.
  LinkRules(std::string robot, const std::vector<std::string>& rules);

  bool allows(Direction direction, const std::string& dds_topic) const;
  /// Whether a sample of an allowed topic continues. Of heartbeats the robot gets only those of a detector that serves
  /// it and of a second link of its name: others are of another robot of this name, which its services would obey.
  bool passes(Direction direction, const std::string& dds_topic, std::span<const std::byte> cdr) const;
  bool is_heartbeat(const std::string& dds_topic) const { return dds_topic == heartbeats_; }
  const std::string& robot() const { return robot_; }

 private:
  const std::string robot_, heartbeats_;
  std::vector<std::string> out_, in_;
};

}  // namespace rtd::link
