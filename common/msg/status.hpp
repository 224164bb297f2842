// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/msg/fields.hpp"

namespace rtd::msg {

enum class ServiceState : std::uint32_t {
  kStarting = 0,
  kReady = 1,
  kRunning = 2,
  kDegraded = 3,
  kFinished = 4,
  kFailed = 5
};
constexpr ServiceState last_value(TypeOf<ServiceState>) {
  return ServiceState::kFailed;
}

constexpr bool is_ready(ServiceState state) {
  return state == ServiceState::kReady || state == ServiceState::kRunning || state == ServiceState::kDegraded;
}

/// A named number of a service: a counter, a queue length, a mean time.
struct Metric {
  std::string name;  ///< e.g. "frames_dropped"
  double value = 0.0;
};
RTD_FIELDS(rtd_msgs, Metric, name, value)

/// Heartbeat of a service: topic `rtd/status`, 5 Hz and at every change of state.
struct ServiceStatus {
  std::string service;  ///< "camera", "detector", "filter", "slam", ...
  std::int64_t pid = 0;
  std::int64_t started_ns = 0;  ///< CLOCK_REALTIME of the process start: the older of two equal services stays
  std::int64_t stamp_ns = 0;    ///< CLOCK_REALTIME
  ServiceState state = ServiceState::kStarting;
  std::string message;  ///< one line for people: why degraded or failed
  std::vector<Metric> metrics;
};
RTD_FIELDS(rtd_msgs, ServiceStatus, service, pid, started_ns, stamp_ns, state, message, metrics)
/// A word of a heartbeat. Metrics have no place for a text, so it follows a prefix in the name: "host_name.robot" = 1.
/// Empty: there is none with that prefix.
inline std::string word_of(const ServiceStatus& status, std::string_view prefix) {
  for (const Metric& metric : status.metrics)
    if (metric.name.starts_with(prefix)) return metric.name.substr(prefix.size());
  return {};
}
/// "camera", "detector/anna": letters, digits and - _ / ..
constexpr bool is_service_name(std::string_view name) {
  const auto is_part = [](char c) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return letter || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '/' || c == '.';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), is_part);
}
inline const char* broken_rule(const ServiceStatus& status) {
  return is_service_name(status.service) ? nullptr : "service";
}

}  // namespace rtd::msg
