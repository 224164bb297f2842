// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_health.hpp"

#include <fstream>
#include <iterator>

namespace rtd::service {
namespace {

constexpr std::int64_t kHungAfterNs = 1'200'000'000, kFarDeadAfterNs = 1'200'000'000;

}  // namespace

PeerHealth judge(const PeerEvidence& evidence) {
  switch (evidence.process) {
    case ProcessState::kGone:
      return evidence.silent_ns >= kSuspectAfterNs ? PeerHealth::kDead : PeerHealth::kAlive;
    case ProcessState::kUnknown:
      return evidence.silent_ns >= kFarDeadAfterNs ? PeerHealth::kDead : PeerHealth::kAlive;
    case ProcessState::kStopped:
    case ProcessState::kRunning:
      break;
  }
  return evidence.silent_ns >= kHungAfterNs ? PeerHealth::kHung : PeerHealth::kAlive;
}

/// "PID (name) STATE ...": the name may contain anything, so the last parenthesis counts.
ProcessState process_state(std::int64_t pid, const std::string& proc_dir) {
  std::ifstream file(proc_dir + '/' + std::to_string(pid) + "/stat");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos || name_end + 2 >= text.size()) return ProcessState::kGone;
  switch (text[name_end + 2]) {
    case 'Z':
    case 'X':
      return ProcessState::kGone;
    case 'T':
    case 't':
      return ProcessState::kStopped;
    default:
      return ProcessState::kRunning;
  }
}

const char* to_string(PeerHealth health) {
  switch (health) {
    case PeerHealth::kAlive:
      return "alive";
    case PeerHealth::kDead:
      return "dead";
    case PeerHealth::kHung:
      break;
  }
  return "hung";
}

}  // namespace rtd::service
