// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_health.hpp"

#include <fstream>
#include <iterator>

namespace rtd::service {
PeerHealth judge(const PeerEvidence& evidence) {
  const bool gone = evidence.process == ProcessState::kGone;
  if (evidence.silent_ns < (gone ? kSuspectAfterNs : kSilentAfterNs)) return PeerHealth::kAlive;
  return evidence.process == ProcessState::kRunning ? PeerHealth::kHung : PeerHealth::kDead;
}

bool surely_gone(const PeerEvidence& evidence) {
  constexpr std::int64_t kSurelyGoneAfterNs = 10'000'000'000;  // then rtd run ends a hung service at these paces
  return evidence.process == ProcessState::kGone || evidence.silent_ns >= kSurelyGoneAfterNs;
}

std::int64_t StandstillWatch::look(std::int64_t now_ns) {
  const std::int64_t away_ns = looked_ns_ == 0 ? 0 : now_ns - looked_ns_;
  looked_ns_ = now_ns;
  return away_ns > limit_ns_ ? away_ns : 0;
}

/// "PID (name) STATE ...": the name may contain anything, so the last parenthesis counts.
ProcessState process_state(std::int64_t pid, const std::string& proc_dir) {
  std::ifstream file(proc_dir + '/' + std::to_string(pid) + "/stat");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos || name_end + 2 >= text.size()) return ProcessState::kGone;
  const char state = text[name_end + 2];
  return state == 'Z' || state == 'X' ? ProcessState::kGone : ProcessState::kRunning;
}

const char* to_string(PeerHealth health) {
  constexpr const char* kNames[] = {"alive", "dead", "hung"};
  return kNames[static_cast<std::size_t>(health)];
}

}  // namespace rtd::service
