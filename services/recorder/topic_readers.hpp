// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "common/service/log.hpp"
#include "services/recorder/core/message_queue.hpp"
#include "services/recorder/core/topic_registry.hpp"

namespace rtd::recorder {

/// Subscribes to every wanted topic of the domain as soon as it has a writer, and queues the messages.
///
/// A reader requests what a writer offers: reliability, and the history of a latched topic. If the writers of a topic
/// offer different QoS, each kind of QoS gets a reader. A reader that requests less also matches the other writers and
/// ignores their samples.
///
/// A replay publishes the texts of its types. Topics whose type is not built in wait for them, because a file has the
/// type before the first message.
class TopicReaders {
 public:
  TopicReaders(bus::RawBus& bus, TopicFilter filter, bool in_place, TopicRegistry& book, MessageQueue& queue);
  ~TopicReaders() { stop(); }
  /// Afterwards nothing is queued.
  void stop();
  /// Subscribes to topics that have waited too long for the text of their type.
  void tick(std::int64_t now_ns);
  bool any() const;
  /// Every known writer is matched with one of our readers.
  bool settled() const;

 private:
  /// What a writer offers: reliable, transient-local.
  using Offer = std::pair<bool, bool>;
  struct Subscription {
    std::size_t topic = 0;
    Offer offer;
    std::map<bus::WriterId, bool> is_mine;  ///< used by the reader's thread
  };

  void on_writer(const bus::TopicWriter& writer, bus::WriterChange change);
  void on_schema_writer(const bus::TopicWriter& writer, bus::WriterChange change);
  void listen_to_schemas(const bus::TopicWriter& writer);
  void learn(const bus::RawSample& sample);
  bool schemas_may_come() const;
  void subscribe_postponed();
  bool postpone(const bus::TopicWriter& writer);
  void try_to_subscribe(const bus::TopicWriter& writer);
  void subscribe(const bus::TopicWriter& writer);
  bus::RawHandlers handlers(const std::shared_ptr<Subscription>& subscription);
  bool is_mine(Subscription& subscription, const bus::WriterId& writer);
  void receive(Subscription& subscription, const bus::RawSample& sample);
  void lose(Subscription& subscription, const bus::RawLoss& loss);

  bus::RawBus& bus_;
  const TopicFilter filter_;
  const bool in_place_;
  TopicRegistry& book_;
  MessageQueue& queue_;
  mutable std::mutex mutex_;
  std::map<std::pair<std::size_t, Offer>, std::unique_ptr<bus::RawReader>> readers_;
  std::set<std::string> refused_;
  std::unique_ptr<bus::RawReader> schema_reader_;
  std::map<bus::WriterId, bool> schemas_read_;  ///< by writer of texts
  std::vector<bus::TopicWriter> postponed_;     ///< until these have come
  std::int64_t postponed_ns_ = 0;               ///< since when
  std::mutex log_mutex_;
  service::RateLimit loss_log_{std::chrono::seconds(1)}, queue_log_{std::chrono::seconds(1)};
};

}  // namespace rtd::recorder
