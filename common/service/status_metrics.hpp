// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "common/msg/status.hpp"

namespace rtd::service {

/// The metric of that name in a heartbeat; empty when it has none.
inline std::optional<double> find_metric(const msg::ServiceStatus& status, const std::string& name) {
  const auto found = std::find_if(status.metrics.begin(), status.metrics.end(),
                                  [&](const msg::Metric& metric) { return metric.name == name; });
  return found == status.metrics.end() ? std::nullopt : std::optional(found->value);
}

}  // namespace rtd::service
