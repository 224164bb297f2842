// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_table.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/bus/topic_roles.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/peer_clocks.hpp"

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

namespace {

constexpr std::size_t kMaxOthers = 100;
constexpr std::int64_t kMakesRoomAfterNs = 10'000'000'000, kForgottenAfterNs = 60'000'000'000;

bool is_ours(const std::string& name) {
  return std::ranges::find(bus::roles(), name) != bus::roles().end();
}

}  // namespace

ProcessRegistry::ProcessRegistry()
    : ProcessRegistry([](std::int64_t pid) { return process_state(pid); }, monotonic_ns) {}

void ProcessRegistry::note(const msg::ServiceStatus& status, const bus::WriterId& writer) {
  constexpr std::size_t kMax = 64;
  const bus::ParticipantId connection = bus::participant_of(writer);
  const bool here = find_metric(status, metric::kHostId) == PeerClocks::this_host_id();
  const std::lock_guard lock(mutex_);
  if (entries_.size() >= kMax && !entries_.contains(connection)) {
    entries_.erase(std::ranges::min_element(entries_, {}, [](const auto& entry) { return entry.second.received_ns; }));
  }
  entries_[connection] = {status.pid, clock_(), here, status.state == msg::ServiceState::kFinished};
}

bool ProcessRegistry::gone(const bus::ParticipantId& connection) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(connection);
  if (found == entries_.end()) return false;
  const Entry& entry = found->second;
  if (entry.finished) return true;
  return entry.here && clock_() - entry.received_ns >= kSuspectAfterNs && look_(entry.pid) == ProcessState::kGone;
}

bool PeerTable::note(const msg::ServiceStatus& status, const bus::WriterId& writer, std::int64_t now_ns) {
  now_ns_ = now_ns;
  const std::string& name = status.service;
  const auto known = names_.find(writer);
  const bool another_name = known != names_.end() && known->second != name;
  if (!believes(name, writer) || another_name || !(gates_.contains(name) || admit(name, now_ns)) ||
      !gates_.at(name).accepts(writer)) {
    ++refused_;
    return false;
  }
  Peer& peer = peers_[name];
  names_.erase(peer.writer);
  names_[writer] = name;
  peer.status = status;
  peer.writer = writer;
  peer.received_ns = now_ns;
  peer.evidence = {};
  return true;
}

void PeerTable::accept_only_from(const std::string& service, std::weak_ptr<const bus::SourceGate> writers) {
  writers_of_[service] = std::move(writers);
}

bool PeerTable::believes(const std::string& service, const bus::WriterId& writer) const {
  const auto known = writers_of_.find(service);
  const auto writers = known == writers_of_.end() ? nullptr : known->second.lock();
  return writers == nullptr || writers->matched(bus::participant_of(writer));
}

/// With its own gate from then on.
bool PeerTable::admit(const std::string& name, std::int64_t now_ns) {
  const auto others = std::ranges::count_if(peers_, [](const auto& peer) { return !is_ours(peer.first); });
  if (!is_ours(name) && static_cast<std::size_t>(others) >= kMaxOthers) {
    const auto age_order = [](const auto& peer) { return std::pair(is_ours(peer.first), peer.second.received_ns); };
    const auto longest = std::ranges::min_element(peers_, {}, age_order);
    if (now_ns - longest->second.received_ns < kMakesRoomAfterNs) return false;
    made_room_.push_back(longest->first);
    erase(made_room_.back());
  }
  bus::SourceGate::Options options;
  options.silence_ns = kSilentAfterNs;
  options.successors_only = false;  // a second box says all the time that it could take over
  options.clock = [this] { return now_ns_; };
  options.gone = gone_;
  gates_.try_emplace(name, std::move(options));
  return true;
}

void PeerTable::erase(const std::string& name) {
  const auto peer = peers_.find(name);
  if (peer == peers_.end()) return;
  names_.erase(peer->second.writer);
  gates_.erase(name);
  peers_.erase(peer);
}

std::vector<std::string> PeerTable::forget_silent(std::int64_t now_ns) {
  std::vector<std::string> gone = std::exchange(made_room_, {});
  const std::size_t before = gone.size();
  for (const auto& [name, peer] : peers_) {
    if (!is_ours(name) && now_ns - peer.received_ns > kForgottenAfterNs) gone.push_back(name);
  }
  for (std::size_t i = before; i < gone.size(); ++i) erase(gone[i]);
  return gone;
}

void PeerTable::exclude_pause(std::int64_t stood_still_ns, std::int64_t now_ns) {
  for (auto& [name, peer] : peers_) peer.received_ns = std::min(peer.received_ns + stood_still_ns, now_ns);
}

}  // namespace rtd::service
