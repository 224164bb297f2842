// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/link/core/link_rules.hpp"

#include <algorithm>
#include <utility>

#include "common/bus/message_cdr.hpp"
#include "common/bus/network.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/io/printable.hpp"
#include "common/msg/plausible.hpp"
#include "common/msg/status.hpp"
#include "common/ros2/names.hpp"

namespace rtd::link {
namespace {

constexpr std::string_view kIn = "in:";

bool matches(const std::vector<std::string>& patterns, const std::string& dds_topic) {
  const std::string unnamed = bus::split_robot(dds_topic).topic;
  return std::ranges::any_of(patterns, [&](const std::string& pattern) {
    return ros2::matches_topic(pattern, dds_topic) || ros2::matches_topic(pattern, unnamed);
  });
}

}  // namespace

const std::vector<std::string>& default_rules() {
  using namespace bus::topics;
  static const std::vector<std::string> kRules = {kColorJpeg.name,
                                                  kCameraInfo.name,
                                                  kPose.name,
                                                  kOdometry.name,
                                                  kTf.name,
                                                  std::string(kIn) + kDetections.name,
                                                  std::string(kIn) + kPersonMasks.name};
  return kRules;
}

LinkRules::LinkRules(std::string robot, const std::vector<std::string>& rules)
    : robot_(std::move(robot)), heartbeats_(bus::topic_of_robot(bus::topics::kStatus.name, robot_)) {
  for (const std::string& rule : rules) {
    const bool in = rule.starts_with(kIn);
    const std::string pattern = in ? rule.substr(kIn.size()) : rule;
    if (pattern.empty())
      throw RuleError("--topics '" + io::abridged(rule) + "': name a topic, e.g. /slam/pose or in:/goal");
    if (bus::stays_on_host(ros2::dds_topic(pattern)))
      throw RuleError("--topics " + rule + ": raw frames and features never leave their host; images pass as JPEG: " +
                      bus::topics::kColorJpeg.name);
    (in ? in_ : out_).push_back(pattern);
  }
}

bool LinkRules::allows(Direction direction, const std::string& dds_topic) const {
  if (is_heartbeat(dds_topic)) return true;
  if (bus::stays_on_host(dds_topic) || !bus::concerns_robot(dds_topic, robot_)) return false;
  return matches(direction == Direction::kToFleet ? out_ : in_, dds_topic);
}

bool LinkRules::passes(Direction direction, const std::string& dds_topic, std::span<const std::byte> cdr) const {
  if (direction == Direction::kToFleet || !is_heartbeat(dds_topic)) return true;
  msg::ServiceStatus status;
  const ros::Bytes bytes{reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()};
  return bus::read_cdr(bytes, status) && msg::is_plausible(status) &&
         (status.service == "detector" || status.service == "link");
}

}  // namespace rtd::link
