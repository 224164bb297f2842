// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

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

}  // namespace rtd::service
