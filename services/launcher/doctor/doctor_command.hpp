// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

namespace rtd::launcher {

struct DoctorOptions {
  bool clean = false;  ///< remove what killed processes left in /dev/shm, say what and why the rest stays, and end
};

/// `rtd doctor`: one line per check (ok, warn, FAIL), each problem with the command that cures it. Returns 0 when a run
/// can start, 1 otherwise.
int doctor(const DoctorOptions& options, std::ostream& out);

}  // namespace rtd::launcher
