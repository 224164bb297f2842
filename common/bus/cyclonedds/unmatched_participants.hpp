// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/bus/callback_thread.hpp"

namespace rtd::bus::cyclonedds {

/// Finds in Cyclone's discovery trace the participants that a secured one cannot match: Cyclone 0.10 reports them
/// nowhere else. The trace has a new participant with its name and whether it has a certificate, a handshake that
/// succeeds with its GUID, one that fails without it: then the only one not yet proven is meant, or else all that
/// have not been for some seconds. Reads no clock; not thread-safe.
class UnmatchedParticipants {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit UnmatchedParticipants(std::uint32_t domain) : domain_(domain) {}
  /// The problems to report after a line, without its header. Each participant is reported once.
  std::vector<std::string> read(std::string_view line, TimePoint now);

 private:
  struct Participant {
    std::string name;
    TimePoint since;
    bool reported = false;
  };
  std::vector<std::string> appeared(std::string_view line, TimePoint now);
  std::vector<std::string> refused(TimePoint now);

  const std::uint32_t domain_;
  std::map<std::string, Participant> unproven_;  ///< by GUID
};

/// Calls BusOptions::on_problem for participants that a secured one cannot match, while it lives. The domain's
/// configuration must have the discovery trace (domain_config).
class UnmatchedWatch {
 public:
  /// None without security or on_problem. To be started before the domain is joined.
  static std::unique_ptr<UnmatchedWatch> start(const BusOptions& options);
  ~UnmatchedWatch();
  UnmatchedWatch(const UnmatchedWatch&) = delete;
  UnmatchedWatch& operator=(const UnmatchedWatch&) = delete;

 private:
  explicit UnmatchedWatch(const BusOptions& options);
  static void dispatch(std::string_view line);
  void read(std::string_view line);

  const std::function<void(const std::string&)> on_problem_;
  UnmatchedParticipants unmatched_;  ///< under the lock of all watches
  CallbackThread thread_;            ///< Cyclone's own hold locks while they write the trace
};

}  // namespace rtd::bus::cyclonedds
