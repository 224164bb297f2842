// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/names.hpp"

#include <fnmatch.h>

#include <regex>

namespace rtd::ros2 {

std::string ros_topic(const std::string& dds_topic) {
  return dds_topic.starts_with("rt/") ? dds_topic.substr(2) : dds_topic;
}

std::string dds_topic(const std::string& ros_topic) {
  return ros_topic.starts_with('/') ? "rt" + ros_topic : ros_topic;
}

bool matches_topic(const std::string& pattern, const std::string& topic) {
  const std::string dds = dds_topic(topic), ros = ros_topic(dds);
  return fnmatch(pattern.c_str(), dds.c_str(), 0) == 0 || fnmatch(pattern.c_str(), ros.c_str(), 0) == 0;
}

std::string ros_type(const std::string& dds_type) {
  static const std::regex kMangled("(\\w+)::(msg|srv|action)::dds_::(\\w+)_");
  return std::regex_replace(dds_type, kMangled, "$1/$2/$3", std::regex_constants::match_continuous);
}

std::string dds_type(const std::string& ros_type) {
  static const std::regex kPlain("(\\w+)/(msg|srv|action)/(\\w+)");
  return std::regex_replace(ros_type, kPlain, "$1::$2::dds_::$3_", std::regex_constants::match_continuous);
}

std::string short_type(const std::string& dds_type) {
  const std::string name = ros_type(dds_type);
  const std::size_t infix = name.find("/msg/");
  return infix == std::string::npos ? std::string() : name.substr(0, infix) + name.substr(infix + 4);
}

}  // namespace rtd::ros2
