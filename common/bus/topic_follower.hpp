// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus {

/// Follows the topics of a connection: knows their writers, and reads them as these offer. A reader requests what each
/// writer of its topic has, reliable samples and earlier ones only while all have them; for a new writer that offers
/// less it is opened again. The first type of a topic counts while it has writers, and no writer of this connection
/// does. All functions but stop(), and all callbacks but those of readers, belong to the thread or lock of
/// Options::run.
class TopicFollower {
 public:
  using Writers = std::map<WriterId, TopicWriter>;

  struct Options {
    /// Which writers are followed.
    std::function<bool(const TopicWriter&)> wants = [](const TopicWriter&) { return true; };
    /// What the reader of a topic calls.
    std::function<RawHandlers(const RawTopic&)> handlers;
    /// A writer that is followed has appeared or changed. May throw BusError, and call read().
    std::function<void(const TopicWriter&)> on_writer = [](const TopicWriter&) {};
    /// The last writer of a topic has gone. With on_demand only.
    std::function<void(const RawTopic&)> on_gone = [](const RawTopic&) {};
    /// The samples of a writer are read now, as these options say.
    std::function<void(const TopicWriter&, const RawReaderOptions&)> on_read = [](const TopicWriter&,
                                                                                  const RawReaderOptions&) {};
    std::function<void(const TopicWriter&, const BusError&)> on_refused = [](const TopicWriter&, const BusError&) {};
    /// Runs a change, which comes on the bus's thread, where it belongs: at once, under a lock, or on another thread.
    std::function<void(std::function<void()>)> run = [](const std::function<void()>& change) { change(); };
    /// Reads only what read() asks for, and closes a reader with the last writer. Else what that one sent may still be
    /// read when it has gone.
    bool on_demand = false;
    RawReaderOptions reader = {.reliable = true, .transient_local = true};  ///< the most that a reader requests
  };

  /// For Options::run: at once, under this lock.
  static std::function<void(std::function<void()>)> under(std::mutex& mutex);

  /// Begins at once; it is the one watcher of `bus`, which outlives it.
  TopicFollower(RawBus& bus, Options options);
  ~TopicFollower() { stop(); }
  TopicFollower(const TopicFollower&) = delete;
  TopicFollower& operator=(const TopicFollower&) = delete;

  /// Afterwards no callback runs. Not under the lock of `run`.
  void stop();
  /// From now on a topic is read whenever it has writers, or no longer. With on_demand only.
  void read(const std::string& topic, bool wanted);
  bool reads(const std::string& topic) const { return wanted_.contains(topic); }
  /// Those of a topic; none when it is not known.
  const Writers& writers(const std::string& topic) const;
  /// The DDS names of those that have writers; without on_demand also of those that had.
  std::vector<std::string> topics() const;

 private:
  struct Followed {
    RawTopic topic;
    Writers writers;
    RawReaderOptions options;
    std::unique_ptr<RawReader> reader;
  };

  void add(const TopicWriter& writer);
  void remove(const TopicWriter& writer);
  void read_from(Followed& followed, const TopicWriter& writer);

  RawBus& bus_;
  const Options options_;
  std::map<std::string, Followed> topics_;  ///< by name
  std::set<std::string> wanted_;            ///< by read()
  bool stopped_ = false;
};

}  // namespace rtd::bus
