// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/backend.hpp"

namespace rtd::bus {

/// What one reader has received of each connection. Bounded: of those that have no writer for it, the source and 63
/// others are known. Thread-safe.
class Input : public std::enable_shared_from_this<Input> {
 public:
  /// `gated`: the reader follows one source at a time (SourceGate).
  Input(std::string topic, bool gated) : topic_(std::move(topic)), gated_(gated) {}

  const std::string& topic() const { return topic_; }
  bool gated() const { return gated_; }
  /// Whose message was taken last.
  std::optional<ParticipantId> source() const;
  /// Messages of a connection, also those that a gate refused. Nothing for one from which the reader expects none: it
  /// has no writer here, or the gate follows another; nor while the reader handles a message.
  std::optional<std::uint64_t> received(const ParticipantId& connection) const;

  /// Both count before they call what is given.
  StatusCallbacks counting(StatusCallbacks callbacks);
  ErasedCallback counting(ErasedCallback on_message);

 private:
  struct Count {
    int writers = 0;
    std::uint64_t received = 0;
  };
  void note_writer(const ParticipantId& connection, bool matched);
  void note_message(const ParticipantId& connection, bool taken);
  Count& count_of(const ParticipantId& connection);
  bool has_writer(const ParticipantId& connection) const;

  const std::string topic_;
  const bool gated_;
  std::atomic<bool> handles_{false};
  mutable std::mutex mutex_;
  std::map<ParticipantId, Count> counts_;
  std::optional<ParticipantId> source_;
};

/// What a process has sent, by topic, and what its readers have received. Thread-safe.
class Traffic {
 public:
  using Sent = std::shared_ptr<std::atomic<std::uint64_t>>;
  /// The one count of a topic's writers.
  Sent output(const std::string& topic);
  /// For a new reader; known until its callbacks are gone.
  std::shared_ptr<Input> input(const std::string& topic, bool gated);

  std::map<std::string, std::uint64_t> sent() const;
  std::vector<std::shared_ptr<const Input>> inputs() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Sent> outputs_;
  std::vector<std::weak_ptr<const Input>> inputs_;
};

}  // namespace rtd::bus
