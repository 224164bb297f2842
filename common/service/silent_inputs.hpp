// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/traffic.hpp"
#include "common/msg/status.hpp"
#include "common/service/peer_table.hpp"

namespace rtd::service {

/// Whether messages of one sender still arrive, as far as it counts them. A reader may be lost for good while
/// everything else of its process continues: docs/topics.md, "Known weakness of Fast DDS". Counts looks instead of
/// time: a process that stood still, or gets little of the processor, has to take what waits for it first. Not
/// thread-safe.
class InputWatch {
 public:
  /// Called ten times a second, with how many messages were received and, as the sender says, sent so far. True when at
  /// least two are missing, the first for twelve looks, and none has arrived for seventeen.
  bool silent(std::uint64_t received, std::uint64_t sent);

 private:
  std::uint64_t received_ = 0, sent_ = 0;  ///< sent_: of these none is missing
  int since_received_ = 0, since_complete_ = 0;
};

/// A service that lives, by its heartbeats.
struct Sender {
  std::string name;
  bus::ParticipantId connection{};
  bool here = false;                          ///< on this host
  std::map<std::string, std::uint64_t> sent;  ///< messages, by topic
};

/// Finds the inputs of a process on which nothing arrives although their writers live and count what they send, or, of
/// heartbeats, although they reach others; logs when one falls silent and when it is back. Not thread-safe.
class SilentInputs {
 public:
  using Inputs = std::vector<std::shared_ptr<const bus::Input>>;
  /// `heartbeats`: their topic.
  explicit SilentInputs(std::string heartbeats) : heartbeats_(std::move(heartbeats)) {}

  /// Called ten times a second; without inputs once the process is to end. `own`: this process, whose readers of its
  /// own topics receive what it sends for sure. `now_ns`: CLOCK_MONOTONIC. True when an input fell silent or is not any
  /// more.
  bool look(const Inputs& inputs, Sender own, const PeerTable& peers, std::int64_t now_ns);
  /// What is said of one for which a restart is worth it; empty: there is none. Its sender is on this host, and the
  /// reader, which follows one source, has followed it; or the topic is that of the heartbeats. So no program ends a
  /// service by its heartbeats alone.
  std::string lost() const;
  /// A metric for each, and of a service that works otherwise state and message.
  void add_to(msg::ServiceStatus& status) const;

 private:
  struct Silent {
    std::string topic, sender;
    bool lost = false;
    std::string text() const { return "nothing arrives on " + topic + ", although " + sender + " sends"; }
    auto operator<=>(const Silent&) const = default;
  };
  std::set<Silent> silent_now(const Inputs& inputs, const std::vector<Sender>& senders);

  const std::string heartbeats_;
  std::map<std::pair<const bus::Input*, bus::ParticipantId>, InputWatch> watches_;
  std::set<Silent> silent_;
};

}  // namespace rtd::service
