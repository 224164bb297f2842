// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::bus::cyclonedds {

/// Throws BusError when no iox-roudi answers on this host: without it iceoryx waits for 60 s and then ends the process.
/// `socket`: where it listens; for tests.
void require_roudi(const std::string& socket = "/tmp/roudi");

}  // namespace rtd::bus::cyclonedds
