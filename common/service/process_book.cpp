// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/process_book.hpp"

#include <algorithm>

#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/peer_clocks.hpp"

namespace rtd::service {

ProcessBook::ProcessBook() : ProcessBook([](std::int64_t pid) { return process_state(pid); }, monotonic_ns) {}

void ProcessBook::note(const msg::ServiceStatus& status, const bus::WriterId& writer) {
  constexpr std::size_t kMax = 64;
  const bus::ParticipantId connection = bus::participant_of(writer);
  const bool here = find_metric(status, metric::kHostId) == PeerClocks::this_host_id();
  const std::lock_guard lock(mutex_);
  if (entries_.size() >= kMax && !entries_.contains(connection)) {
    entries_.erase(std::ranges::min_element(entries_, {}, [](const auto& entry) { return entry.second.received_ns; }));
  }
  entries_[connection] = {status.pid, clock_(), here, status.state == msg::ServiceState::kFinished};
}

bool ProcessBook::gone(const bus::ParticipantId& connection) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(connection);
  if (found == entries_.end()) return false;
  const Entry& entry = found->second;
  if (entry.finished) return true;
  return entry.here && clock_() - entry.received_ns >= kSuspectAfterNs && look_(entry.pid) == ProcessState::kGone;
}

}  // namespace rtd::service
