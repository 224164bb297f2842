// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>

#include "common/bus/writer_id.hpp"
#include "common/msg/status.hpp"
#include "common/service/peer_health.hpp"

namespace rtd::service {

/// Which processes are behind the connections of a domain, by their heartbeats. A connection speaks for itself only: a
/// heartbeat is noted under the id of the connection that sent it. Holds the 64 newest. Thread-safe.
class ProcessBook {
 public:
  using Look = std::function<ProcessState(std::int64_t pid)>;
  using Clock = std::function<std::int64_t()>;
  ProcessBook();
  /// `clock`: monotonic, ns.
  ProcessBook(Look look, Clock clock) : look_(std::move(look)), clock_(std::move(clock)) {}

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

}  // namespace rtd::service
