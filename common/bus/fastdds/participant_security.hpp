// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "common/bus/bus_factory.hpp"
#include "common/bus/fastdds/versions/vendor.hpp"

namespace rtd::bus::fastdds {

/// The enclave's files as Fast DDS's built-in plugins want them. No change without security.
void map_security(const SecurityOptions& security, dds::DomainParticipantQos& qos);

/// Leaves the shared memory that this process uses to its user. Fast DDS lets every user of the host read it, and the
/// raw frames that go through it to readers without our rings are not encrypted.
void hide_shared_memory();

/// Calls BusOptions::on_problem, once each, for participants that a secured one cannot match. Thread-safe.
class SecurityWatch {
 public:
  explicit SecurityWatch(const BusOptions& options);
  void discovered(const FoundParticipant& participant);
  void refused(const ParticipantId& participant);

 private:
  const std::uint32_t domain_;
  const std::function<void(const std::string&)> on_problem_;
  std::mutex mutex_;
  std::map<ParticipantId, std::string> names_;  ///< of those not reported yet; else empty
};

}  // namespace rtd::bus::fastdds
