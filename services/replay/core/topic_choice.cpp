// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/topic_choice.hpp"

#include <algorithm>
#include <array>

#include "common/bus/robot.hpp"
#include "common/ros2/names.hpp"
#include "common/service/config.hpp"

namespace rtd::replay {
namespace {

constexpr char kHeartbeats[] = "rtd/status";

bool matches(const std::string& pattern, const std::string& topic) {
  return ros2::matches_topic(pattern, topic) ||
         ros2::matches_topic(pattern, bus::split_robot(ros2::dds_topic(topic)).topic);
}

bool matches_any(const std::vector<std::string>& patterns, const std::string& topic) {
  return std::ranges::any_of(patterns, [&](const std::string& pattern) { return matches(pattern, topic); });
}

std::string topic_name(const std::string& name, const std::string& whole) {
  if (name.empty() || name.find_first_of(" \t\n*?") != std::string::npos)
    throw service::ConfigError("--remap " + whole + ": '" + name +
                               "' is not a topic name; write old:=new, e.g. /slam/pose:=/old/pose");
  return ros2::dds_topic(name);
}

}  // namespace

bool is_cdr(const mcap::Channel& channel) {
  return channel.message_encoding == "cdr";
}

std::string encoding_of(const mcap::Channel& channel) {
  return channel.message_encoding.empty() ? "none" : channel.message_encoding;
}

bool is_run_topic(const std::string& dds_topic) {
  constexpr std::array<std::string_view, 5> kOfARun = {"rtd/", "rt/detector/", "rt/filter/", "rt/slam/", "rt/dense/"};
  const bus::RobotTopic topic = bus::split_robot(dds_topic);
  return std::ranges::any_of(kOfARun, [&](std::string_view prefix) { return topic.topic.starts_with(prefix); });
}

bool TopicChoice::wants(const std::string& topic) const {
  if (matches_any(excluded_, topic)) return false;
  return wanted_.empty() ? bus::split_robot(topic).topic != kHeartbeats : matches_any(wanted_, topic);
}

std::vector<std::string> TopicChoice::unmet(const std::vector<std::string>& topics) const {
  std::vector<std::string> unmet;
  for (const std::string& pattern : wanted_)
    if (std::ranges::none_of(topics, [&](const std::string& topic) { return matches(pattern, topic); }))
      unmet.push_back(pattern);
  return unmet;
}

std::map<std::string, std::string> parse_remaps(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> remaps;
  for (const std::string& text : texts) {
    const std::size_t sign = text.find(":=");
    if (sign == std::string::npos)
      throw service::ConfigError("--remap " + text + ": write old:=new, e.g. /slam/pose:=/old/pose");
    const std::string from = topic_name(text.substr(0, sign), text), to = topic_name(text.substr(sign + 2), text);
    if (!remaps.emplace(from, to).second)
      throw service::ConfigError("--remap " + text + ": " + from + " is renamed twice");
  }
  return remaps;
}

}  // namespace rtd::replay
