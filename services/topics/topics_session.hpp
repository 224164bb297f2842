// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/service/command_line.hpp"
#include "services/topics/topics_command.hpp"

namespace rtd::topics {

inline constexpr int kReaderDepth = 64;  ///< samples that a reader of these commands keeps

/// Whether the topic has this ROS or DDS name.
bool is_called(const bus::RawTopic& topic, const std::string& name);

/// A command that looks at a domain until it is interrupted.
class TopicsSession {
 public:
  using Clock = std::chrono::steady_clock;

  /// Throws ConfigError and BusError.
  explicit TopicsSession(const service::ConfigSources& sources);

  bus::RawBus& bus() { return *bus_; }
  /// Waits a moment for a signal; false from the first signal on.
  bool continues(std::chrono::milliseconds moment);
  double seconds() const;  ///< since the start
  /// The writers of other participants; with --robot without the topics of other robots.
  std::vector<bus::TopicWriter> writers() const;
  /// "DDS domain 0 (fastdds, this host only; --profile lan: also the network)".
  std::string place() const;
  /// The same when nothing was found there: also the domains in which DDS runs on this host.
  std::string empty_place() const;
  /// Says that a topic has no publisher, and which topics have one.
  std::string no_publisher_of(const std::string& topic) const;

 private:
  service::InterruptSignals signals_;  // first: before any thread
  bus::BusOptions options_;
  Clock::time_point start_ = Clock::now();
  bool interrupted_ = false;
  std::shared_ptr<bus::RawBus> bus_;
};

int list_topics(const TopicsRequest& request, TopicsSession& session, std::ostream& out, std::ostream& err);
int measure_topics(const TopicsRequest& request, TopicsSession& session, std::ostream& out, std::ostream& err);
int echo_topic(const TopicsRequest& request, TopicsSession& session, std::ostream& out, std::ostream& err);
/// Publishes our topics rtd/... of the domain, or those named, as /rtd/... until it is interrupted; images and features
/// are left out.
int mirror_topics(const TopicsRequest& request, TopicsSession& session, std::ostream& out);

}  // namespace rtd::topics
