// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "common/service/bus_config.hpp"

namespace rtd::launcher {

struct DoctorOptions {
  bool clean = false;  ///< remove what killed processes left in /dev/shm, say what and why the rest stays, and end
  service::BusArguments bus;      ///< how the services are going to join the bus
  service::ConfigSources config;  ///< as theirs
};

/// `rtd doctor`: one line per check (ok, warn, FAIL), each problem with the command that cures it. Returns 0 when a run
/// can start so, 1 when something failed, 2 when the arguments or the configuration are wrong (said to `err`).
int doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::launcher
