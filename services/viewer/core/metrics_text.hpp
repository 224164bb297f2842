// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/viewer/core/page_messages.hpp"

/// The services for monitoring: Prometheus's text format, version 0.0.4, and a summary for health checks.
namespace rtd::viewer {

/// A service as its last heartbeat has it.
struct WatchedService {
  std::string robot;  ///< "": without a name
  page::ServiceLine line;
};

/// Every metric of every heartbeat, as "rtd_SERVICE_METRIC" in base units (s, m, bytes, fractions of 1), with the
/// labels robot, service and host; metrics about a topic or a peer have it as label "of". `rtd_service_up` is 0 for a
/// service that is silent or has failed; one that has ended in order is left out.
std::string metrics_text(const std::vector<WatchedService>& services);

struct Health {
  bool well = true;  ///< no service has failed or fallen silent
  std::string json;  ///< {"status":"ok","services":[{"robot","service","host","state","message","age_s"}]}
};
Health health_of(const std::vector<WatchedService>& services);

}  // namespace rtd::viewer
