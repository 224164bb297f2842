// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/bus/host/host_checks.hpp"

namespace rtd::bus::cyclonedds {

/// Cyclone's configuration of a domain, as XML. Throws BusError: an interface or peer that is none
/// (common/bus/network.hpp).
std::string domain_config(const BusOptions& options, const HostLimits& limits);

/// Throws BusError when no iox-roudi answers on this host: without it iceoryx waits for 60 s and then ends the process.
/// `socket`: where it listens; for tests.
void require_roudi(const std::string& socket = "/tmp/roudi");

}  // namespace rtd::bus::cyclonedds
