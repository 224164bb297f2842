// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/topic_follower.hpp"
#include "common/ros2/type_description.hpp"
#include "services/viewer/core/foxglove_hub.hpp"
#include "services/viewer/dispatcher.hpp"

namespace rtd::viewer {

/// The topics of a domain as Foxglove channels: offered while they have a writer, read only while a client subscribes.
/// Everything runs in the viewer's thread; the bus's threads only post.
class TopicFeed {
 public:
  /// `robots_changed` is called when topics appear or go. Ends with stop().
  TopicFeed(bus::RawBus& bus, FoxgloveHub& hub, Dispatcher dispatcher, std::vector<std::string> patterns,
            std::function<void()> robots_changed);
  ~TopicFeed() { stop(); }
  TopicFeed(const TopicFeed&) = delete;
  TopicFeed& operator=(const TopicFeed&) = delete;

  /// Afterwards nothing is posted.
  void stop();
  /// A channel got its first subscriber, or lost its last.
  void want(std::uint32_t channel, bool wanted);
  /// DDS names of topics that have writers.
  std::vector<std::string> topics() const { return follower_.topics(); }
  /// Reports to the hub who writes, reads and offers what now. Readers that come and go are seen only here.
  void update_graph();
  /// Publishes a client's message; returns why not, or "".
  std::string publish(const std::string& topic, const std::string& type, std::span<const std::byte> cdr);

 private:
  struct Entry {
    bus::RawTopic topic;
    std::uint32_t channel = 0;  ///< 0: not offered
  };

  void add(const bus::TopicWriter& writer);
  void remove(const std::string& topic);
  bool allowed(const std::string& topic) const;
  foxglove::Schema schema_of(const std::string& dds_type) const;
  void learn_types(const bus::TopicWriter& writer);
  void learn(const bus::RawSample& sample);
  bus::RawHandlers handlers(const Entry& entry);

  bus::RawBus& bus_;
  FoxgloveHub& hub_;
  const Dispatcher dispatcher_;
  const std::vector<std::string> patterns_;
  const std::function<void()> robots_changed_;
  std::map<std::string, Entry> entries_;  ///< by topic
  std::map<std::string, ros2::TypeDefinition> learned_;
  std::unique_ptr<bus::RawReader> schema_reader_;
  std::map<std::string, std::unique_ptr<bus::RawWriter>> published_;  ///< by topic, for clients
  bool stopped_ = false;
  bus::TopicFollower follower_;
};

}  // namespace rtd::viewer
