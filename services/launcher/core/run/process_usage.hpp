// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rtd::launcher {

/// Peak resident memory in MB (VmHWM), from the text of /proc/PID/status; -1 when absent (the process is ending).
double peak_rss_mb(const std::string& proc_status);

}  // namespace rtd::launcher
