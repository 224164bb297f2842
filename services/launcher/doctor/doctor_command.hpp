// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "common/service/bus_config.hpp"

namespace rtd::launcher {

struct DoctorOptions {
  bool clean = false;  ///< only remove what killed processes left in /dev/shm, and list what was removed and what stays
  service::BusArguments bus;      ///< how the services will join the bus
  service::ConfigSources config;  ///< the same as theirs
};

/// `rtd doctor`: one line per check (ok, warn, FAIL), each problem with the command that fixes it. Returns 0 when a
/// run can start with these options, 1 when a check failed, 2 when arguments or configuration are wrong (see `err`).
int doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::launcher
