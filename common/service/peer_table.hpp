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

namespace rtd::service {

enum class ProcessState {
  kUnknown,
  kRunning,  ///< or stopped by a signal
  kGone
};
enum class PeerHealth {
  kAlive,
  kDead,  ///< its process is gone, or nothing is received from another host
  kHung   ///< its process is there and silent: stopped, or stuck
};

/// What is known of a service that sent heartbeats before.
struct PeerEvidence {
  std::int64_t silent_ns = 0;                     ///< since its last heartbeat
  ProcessState process = ProcessState::kUnknown;  ///< kUnknown: on another host
};

/// Heartbeats come five times a second. A process that is gone counts after one and a half, so that the others know
/// within 0.5 s; a silent one that is still there may only wait for the processor, and has 1.2 s.
PeerHealth judge(const PeerEvidence& evidence);
/// Silence from which on it is worth to look at the process.
constexpr std::int64_t kSuspectAfterNs = 300'000'000;
/// Silence from which on one whose process is there, or on another host, does not count as alive.
constexpr std::int64_t kSilentAfterNs = 1'200'000'000;
/// For what must not depend on the load of the host: its process is gone, or it has been silent for ten seconds.
bool surely_gone(const PeerEvidence& evidence);

/// From /proc/PID/stat; a zombie is gone.
ProcessState process_state(std::int64_t pid, const std::string& proc_dir = "/proc");

const char* to_string(PeerHealth health);

/// Notices that this process itself stood still: it was stopped, its container was paused, or the host had no processor
/// time for it. What others did not send meanwhile is not their silence. Times are given. Not thread-safe.
class StandstillWatch {
 public:
  /// `limit_ns`: what lies between two looks at most while the process runs.
  explicit StandstillWatch(std::int64_t limit_ns = 500'000'000) : limit_ns_(limit_ns) {}
  /// How long it stood still before this look; 0: it did not.
  std::int64_t look(std::int64_t now_ns);

 private:
  const std::int64_t limit_ns_;
  std::int64_t looked_ns_ = 0;
};

/// Whether a worker loop continues: it ticks in each round. Silence while it waits on purpose does not count. Times are
/// given. Not thread-safe.
class ProgressWatch {
 public:
  /// 0: never hung.
  void set_limit(std::int64_t limit_ns) { limit_ns_ = limit_ns; }
  void tick(std::int64_t now_ns) { ticked_ns_ = now_ns; }
  void idle() { ticked_ns_ = 0; }  ///< until the next tick
  /// The whole process stood still for so long.
  void exclude_pause(std::int64_t stood_still_ns) {
    if (ticked_ns_ > 0) ticked_ns_ += stood_still_ns;
  }
  /// How long the worker has been stuck; 0: it continues, or has not begun.
  std::int64_t stuck_ns(std::int64_t now_ns) const {
    const bool stuck = limit_ns_ > 0 && ticked_ns_ > 0 && now_ns - ticked_ns_ > limit_ns_;
    return stuck ? now_ns - ticked_ns_ : 0;
  }

 private:
  std::int64_t limit_ns_ = 0, ticked_ns_ = 0;
};

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
