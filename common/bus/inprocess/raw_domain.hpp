// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "common/bus/inprocess/mailbox.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::inprocess {

struct RawWriterEndpoint {
  TopicWriter writer;
  std::int64_t sequence = 0;                              ///< guarded by the domain
  std::deque<std::shared_ptr<const RawSample>> retained;  ///< transient-local history, guarded by the domain
  std::atomic<int> matched{0};
};

struct RawReaderEndpoint {
  RawTopic topic;
  RawReaderOptions options;
  Mailbox* mailbox = nullptr;
  std::atomic<int> matched{0};
};

struct RawWatcher {
  RawBus::Watcher call;
  CallbackThread* thread = nullptr;
};

/// All raw endpoints and watchers of one domain number in this process. Thread-safe; never runs a callback under its
/// lock.
class RawDomain {
 public:
  static std::shared_ptr<RawDomain> join(std::uint32_t number);

  WriterId new_id();
  std::vector<TopicWriter> writers() const;
  void add(RawWriterEndpoint& writer);
  void add(RawReaderEndpoint& reader);
  void add(RawWatcher& watcher);
  void remove(RawWriterEndpoint& writer);
  void remove(RawReaderEndpoint& reader);
  void remove(RawWatcher& watcher);
  void publish(RawWriterEndpoint& writer, RawSample sample);

 private:
  void tell(const TopicWriter& writer, WriterChange change);

  mutable std::mutex mutex_;
  std::uint32_t ids_ = 0;
  std::vector<RawWriterEndpoint*> writers_;
  std::vector<RawReaderEndpoint*> readers_;
  std::vector<RawWatcher*> watchers_;
};

}  // namespace rtd::bus::inprocess
