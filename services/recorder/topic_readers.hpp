// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "common/bus/raw_bus.hpp"
#include "common/service/log.hpp"
#include "services/recorder/core/message_queue.hpp"
#include "services/recorder/core/topic_book.hpp"
#include "services/recorder/core/topic_filter.hpp"

namespace rtd::recorder {

/// Listens to every wanted topic of the domain, from the moment in which somebody writes it, and queues what comes.
///
/// A reader asks for what a writer offers: reliable, and the history of a latched topic. Writers of one topic that
/// offer different things get a reader each kind; the modest ones match the others too, whose samples are then left out
/// there.
class TopicReaders {
 public:
  TopicReaders(bus::RawBus& bus, TopicFilter filter, bool in_place, TopicBook& book, MessageQueue& queue);
  ~TopicReaders() { stop(); }
  /// Nothing is queued any more.
  void stop();
  bool any() const;
  /// Every writer that is known has a reader of ours that knows it.
  bool settled() const;

 private:
  /// What a writer offers: reliable, transient-local.
  using Offer = std::pair<bool, bool>;
  struct Listener {
    std::size_t topic = 0;
    Offer offer;
    std::map<bus::WriterId, bool> is_mine;  ///< used by the reader's thread
  };

  void take_note(const bus::TopicWriter& writer, bus::WriterChange change);
  void listen(const bus::TopicWriter& writer);
  bus::RawHandlers handlers(const std::shared_ptr<Listener>& listener);
  bool is_mine(Listener& listener, const bus::WriterId& writer);
  void receive(Listener& listener, const bus::RawSample& sample);
  void lose(Listener& listener, const bus::RawLoss& loss);

  bus::RawBus& bus_;
  const TopicFilter filter_;
  const bool in_place_;
  TopicBook& book_;
  MessageQueue& queue_;
  mutable std::mutex mutex_;
  std::map<std::pair<std::size_t, Offer>, std::unique_ptr<bus::RawReader>> readers_;
  std::set<std::string> refused_;
  std::mutex log_mutex_;
  service::RateLimit loss_log_{std::chrono::seconds(1)}, queue_log_{std::chrono::seconds(1)};
};

}  // namespace rtd::recorder
