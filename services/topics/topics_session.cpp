// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/topics_session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>

#include <iostream>
#include <set>

#include "common/bus/port_check.hpp"
#include "common/bus/robot.hpp"
#include "common/ros2/names.hpp"
#include "common/service/bus_config.hpp"

namespace rtd::topics {

bool is_called(const bus::RawTopic& topic, const std::string& name) {
  return topic.name == name || ros2::ros_topic(topic.name) == name || ros2::ros_topic(topic.name) == '/' + name;
}

TopicsSession::TopicsSession(const service::ConfigSources& sources)
    : options_(service::load_bus_options(sources, "rtd-topics")), bus_(bus::connect_raw(options_)) {
  for (const bus::EnvironmentSetting& setting : options_.environment) {
    if (!setting.followed) std::cerr << "rtd topics: " << setting.text << '\n';
  }
}

bool TopicsSession::continues(std::chrono::milliseconds moment) {
  pollfd descriptor{signals_.fd(), POLLIN, 0};
  if (!interrupted_ && poll(&descriptor, 1, static_cast<int>(moment.count())) > 0) interrupted_ = signals_.take() > 0;
  return !interrupted_;
}

double TopicsSession::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

std::vector<bus::TopicWriter> TopicsSession::writers() const {
  std::vector<bus::TopicWriter> writers = bus_->writers();
  std::erase_if(writers, [this](const bus::TopicWriter& writer) {
    const bool hidden = !options_.robot.empty() && !bus::concerns_robot(writer.topic.name, options_.robot);
    return writer.own || hidden || bus::is_internal_to_ros(writer.topic.name);
  });
  return writers;
}

std::string TopicsSession::place() const {
  return fmt::format(
      "DDS domain {} ({}, {})", options_.domain, bus_->vendor(),
      options_.network.loopback_only ? "this host only; --profile lan: also the network" : "this host and the network");
}

std::string TopicsSession::empty_place() const {
  return place() + bus::other_domains_hint(options_.domain);
}

std::string TopicsSession::no_publisher_of(const std::string& topic) const {
  std::set<std::string> names;
  for (const bus::TopicWriter& writer : writers()) names.insert(ros2::ros_topic(writer.topic.name));
  const std::string found = names.empty() ? "nothing is published" + bus::other_domains_hint(options_.domain)
                                          : fmt::format("published topics: {}", fmt::join(names, ", "));
  return fmt::format("{} has no publisher in {}; {}", topic, place(), found);
}

}  // namespace rtd::topics
