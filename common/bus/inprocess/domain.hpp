// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/callback_thread.hpp"
#include "common/bus/inprocess/mailbox.hpp"
#include "common/bus/qos_settings.hpp"

namespace rtd::bus::inprocess {

/// What writers and readers have in common.
struct Endpoint {
  MessageId type;
  std::string topic;
  QosSettings qos;
  StatusCallbacks callbacks;
  std::atomic<int> matched{0};
  CallbackThread* thread = nullptr;  ///< runs the callbacks; null when there are none
};

struct WriterEndpoint : Endpoint {
  std::deque<Message> retained;  ///< transient-local history, guarded by the domain
};

struct ReaderEndpoint : Endpoint {
  Mailbox* mailbox = nullptr;
  int lost = 0;  ///< messages pushed out of the full mailbox, guarded by the domain
};

/// All endpoints of one domain number in this process. Thread-safe; never runs a callback under its lock.
class Domain {
 public:
  /// The domain of that number; lives as long as somebody holds it.
  static std::shared_ptr<Domain> join(std::uint32_t number);

  void add(WriterEndpoint& writer);
  void add(ReaderEndpoint& reader);
  /// After remove() returns nothing is handed to the endpoint any more.
  void remove(WriterEndpoint& writer);
  void remove(ReaderEndpoint& reader);
  void publish(WriterEndpoint& writer, const Message& message);

 private:
  static void deliver(ReaderEndpoint& reader, const Message& message);

  std::mutex mutex_;
  std::vector<WriterEndpoint*> writers_;
  std::vector<ReaderEndpoint*> readers_;
};

}  // namespace rtd::bus::inprocess
