// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/source_gate.hpp"
#include "common/bus/writer_id.hpp"
#include "common/msg/status.hpp"
#include "common/service/peer_health.hpp"

namespace rtd::service {

/// Which processes are behind the connections of a domain, by their heartbeats. A connection speaks for itself only: a
/// heartbeat is noted under the id of the connection that sent it. Holds the 64 newest. Thread-safe.
class ProcessRegistry {
 public:
  using Look = std::function<ProcessState(std::int64_t pid)>;
  using Clock = std::function<std::int64_t()>;
  ProcessRegistry();
  /// `clock`: monotonic, ns.
  ProcessRegistry(Look look, Clock clock) : look_(std::move(look)), clock_(std::move(clock)) {}

  void note(const msg::ServiceStatus& status, const bus::WriterId& writer);
  /// Whether it said that it ends, or its process on this host is no more and its heartbeats have ceased. False for one
  /// that is not known.
  bool gone(const bus::ParticipantId& connection) const;

 private:
  struct Entry {
    std::int64_t pid = 0, received_ns = 0;
    bool here = false, finished = false;
  };
  const Look look_;
  const Clock clock_;
  mutable std::mutex mutex_;
  std::map<bus::ParticipantId, Entry> entries_;
};

/// A service as its heartbeats show it.
struct Peer {
  msg::ServiceStatus status;
  bus::WriterId writer{};
  std::int64_t received_ns = 0;
  PeerHealth health = PeerHealth::kAlive;
  PeerEvidence evidence{};  ///< as it was looked at last; empty since its last heartbeat
};

/// The other services of a domain by name. Bounded, and not to be fooled by invented names:
/// - A name belongs to the connection that uses it first, until its process is gone or it was silent for 1.2 s; then
///   another one may use it, until a message of the first arrives again.
/// - One writer has one name.
/// - The names of this system's own services (bus::roles()) always have a place. Of others there are 100 at most; one
///   that is silent for 10 s makes room for a new one, and is forgotten after a minute.
/// Times are given, CLOCK_MONOTONIC. Not thread-safe.
class PeerTable {
 public:
  /// `gone`: as SourceGate::Options::gone.
  explicit PeerTable(std::function<bool(const bus::ParticipantId&)> gone) : gone_(std::move(gone)) {}

  /// False for a heartbeat that does not count.
  bool note(const msg::ServiceStatus& status, const bus::WriterId& writer, std::int64_t now_ns);
  /// From now on heartbeats of that service count only while a writer of their connection is matched behind the gate.
  /// Once the gate is gone, they count from every connection again.
  void accept_only_from(const std::string& service, std::weak_ptr<const bus::SourceGate> writers);
  /// Forgets who has been silent for long; the names that go.
  std::vector<std::string> forget_silent(std::int64_t now_ns);
  /// This process stood still for so long: no service was silent meanwhile. Heartbeats may have come since.
  void exclude_pause(std::int64_t stood_still_ns, std::int64_t now_ns);

  std::map<std::string, Peer>& peers() { return peers_; }
  const std::map<std::string, Peer>& peers() const { return peers_; }
  /// Heartbeats that did not count.
  std::uint64_t refused() const { return refused_; }

 private:
  bool believes(const std::string& service, const bus::WriterId& writer) const;
  bool admit(const std::string& name, std::int64_t now_ns);
  void erase(const std::string& name);

  const std::function<bool(const bus::ParticipantId&)> gone_;
  std::int64_t now_ns_ = 0;  ///< of the heartbeat at hand, for the gates
  std::map<std::string, Peer> peers_;
  std::map<std::string, bus::SourceGate> gates_;                            ///< by name, as peers_
  std::map<bus::WriterId, std::string> names_;                              ///< at most one for each peer
  std::map<std::string, std::weak_ptr<const bus::SourceGate>> writers_of_;  ///< by service
  std::vector<std::string> made_room_;
  std::uint64_t refused_ = 0;
};

}  // namespace rtd::service
