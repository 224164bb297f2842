// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::launcher {

/// CPU time of a process in clock ticks (user + system, all threads), from the text of /proc/PID/stat; -1 when
/// malformed. The command name in it may hold spaces and parentheses.
long long cpu_ticks(const std::string& proc_stat);

/// Peak resident memory in MB (VmHWM), from the text of /proc/PID/status; -1 when absent (the process is ending).
double peak_rss_mb(const std::string& proc_status);

}  // namespace rtd::launcher
