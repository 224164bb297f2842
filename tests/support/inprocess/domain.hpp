// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/callback_thread.hpp"
#include "common/bus/discovery.hpp"

namespace rtd::bus::inprocess {

/// What crosses: the message and the id of its writer.
struct Message {
  std::shared_ptr<const void> content;
  WriterId writer{};
};

/// What waits for one reader: at most `depth` messages; one more pushes the oldest out, as a keep-last history does.
/// Thread-safe.
class DeliveryQueue {
 public:
  DeliveryQueue(int depth, std::function<void(Message)> on_message)
      : depth_(static_cast<std::size_t>(depth)),
        on_message_(std::move(on_message)),
        thread_([this] { return handle_one(); }) {}

  /// Never blocks. False when an older message had to go.
  bool deliver(Message message);
  CallbackThread& thread() { return thread_; }

 private:
  bool handle_one();

  const std::size_t depth_;
  const std::function<void(Message)> on_message_;
  std::mutex mutex_;
  std::deque<Message> messages_;
  CallbackThread thread_;
};

/// The policy in which a reader asks for more than a writer offers, by its DDS name, e.g. "DURABILITY"; empty when they
/// match.
std::string incompatible_policy(const QosSettings& offered, const QosSettings& requested);

/// What a writer offers or a reader asks for.
struct EndpointKind {
  std::string topic, type;
  QosSettings qos;
  bool reliable = true;
};

struct WriterEndpoint {
  EndpointKind kind;
  StatusReporter status;
  WriterId id{};
  std::optional<TopicWriter> discovered = {};  ///< as the registries get it; empty: not at all
  std::deque<Message> retained = {};           ///< transient-local history, guarded by the domain
};

struct ReaderEndpoint {
  ReaderEndpoint(EndpointKind what, StatusCallbacks callbacks, std::function<void(Message)> on_message)
      : kind(std::move(what)),
        deliveries(kind.qos.depth, std::move(on_message)),
        status(std::move(callbacks), deliveries.thread()) {}
  ~ReaderEndpoint() { deliveries.thread().stop(); }  // it uses the others
  ReaderEndpoint(const ReaderEndpoint&) = delete;
  ReaderEndpoint& operator=(const ReaderEndpoint&) = delete;

  EndpointKind kind;
  WriterId id{};  ///< given by the domain
  int lost = 0;   ///< messages pushed out of the full queue, guarded by the domain
  DeliveryQueue deliveries;
  StatusReporter status;
};

/// All endpoints of one domain number in this process. Thread-safe; never runs a callback under its lock.
class Domain {
 public:
  /// Typed messages have no bytes here, so typed and raw endpoints have their own domains.
  enum class Content { kTyped, kRaw };
  /// The domain of that number; lives as long as a connection holds it.
  static std::shared_ptr<Domain> join(std::uint32_t number, Content content);

  /// The id of a connection, or of an endpoint that stands for one.
  WriterId new_id();
  /// The id of an endpoint of a connection.
  WriterId new_id(const WriterId& connection);
  /// A registry gets the writers known now, then all changes.
  void add(EndpointRegistry& registry);
  void add(WriterEndpoint& writer);
  void add(ReaderEndpoint& reader);
  /// After remove() returns the endpoint gets nothing any more.
  void remove(EndpointRegistry& registry);
  void remove(WriterEndpoint& writer);
  void remove(ReaderEndpoint& reader);
  std::vector<TopicReader> readers() const;
  void publish(WriterEndpoint& writer, std::shared_ptr<const void> content);

 private:
  WriterId next_id();

  mutable std::mutex mutex_;
  std::uint32_t ids_ = 0;
  std::vector<EndpointRegistry*> registries_;
  std::vector<WriterEndpoint*> writers_;
  std::vector<ReaderEndpoint*> readers_;
};

}  // namespace rtd::bus::inprocess
