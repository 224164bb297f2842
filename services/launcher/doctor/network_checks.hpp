// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/bus_factory.hpp"
#include "services/launcher/doctor/findings.hpp"

namespace rtd::launcher {

/// What the network settings ask of this host: interfaces that are up, peers that can be named and reached, UDP ports
/// that are free.
void check_network(const bus::BusOptions& options, Findings& findings);

}  // namespace rtd::launcher
