// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/host_checks.hpp"

namespace rtd::bus::cyclonedds {

/// Names or addresses of the host's network interfaces that are up, without loopback, at most as many as Cyclone uses.
std::vector<std::string> network_interfaces();

/// Cyclone's configuration of a domain, as XML. Throws BusError: a peer or interface that cannot be one.
std::string domain_config(const BusOptions& options, const HostLimits& limits);

}  // namespace rtd::bus::cyclonedds
