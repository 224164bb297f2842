// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "common/bus/topic_follower.hpp"
#include "services/link/core/link_rules.hpp"

namespace rtd::link {

/// What has passed on one topic.
struct Passed {
  std::string topic;
  std::uint64_t messages = 0, bytes = 0;
  std::uint64_t lost = 0;  ///< sent on one side but not received here, or refused on the other
  bool wanted = false;     ///< it has readers on the other side
};

/// Passes the allowed topics of one domain to another, byte for byte, with the type, QoS and times of their writers. A
/// topic exists on the other side as long as it has a writer on this one. It is read here only while it has readers
/// there, so a camera encodes no image that no one reads; topics for late readers (transient local) are read always.
/// What this process has itself written here, for the other direction, does not go back.
class OneWay {
 public:
  /// Begins at once; tick() keeps it going. Both connections outlive it, and `from` has no other watcher.
  OneWay(bus::RawBus& from, bus::RawBus& to, const LinkRules& rules, Direction direction);

  /// Opens and closes readers as the other side wants them. To be called often, by one thread.
  void tick();
  std::vector<Passed> passed() const;

 private:
  /// One topic. The callbacks of its reader hold it, without a lock.
  struct Route {
    std::string topic;
    std::unique_ptr<bus::RawWriter> writer;   ///< null while the topic has none here
    std::map<bus::WriterId, bool> by_others;  ///< used by the reader's thread
    std::atomic<std::uint64_t> messages{0}, bytes{0}, lost{0};
  };

  void add(const bus::TopicWriter& source);
  void remove(const std::string& topic);
  void refuse(const std::string& topic, const bus::BusError& error);
  bool always_read(const Route& route) const;
  bus::RawHandlers handlers(Route& route);
  void pass(Route& route, const bus::RawSample& sample);
  bool written_by_others(Route& route, const bus::WriterId& writer) const;

  bus::RawBus& from_;
  bus::RawBus& to_;
  const LinkRules& rules_;
  const Direction direction_;
  mutable std::mutex mutex_;
  std::map<std::string, std::unique_ptr<Route>> routes_;  ///< by topic
  std::set<std::string> refused_;                         ///< topics that could not be opened, for the log
  bus::TopicFollower follower_;                           ///< last: its reader uses the routes
};

}  // namespace rtd::link
