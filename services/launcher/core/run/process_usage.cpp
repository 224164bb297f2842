// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/process_usage.hpp"

#include <sstream>

namespace rtd::launcher {

double peak_rss_mb(const std::string& proc_status) {
  const std::string key = "VmHWM:";
  const std::size_t at = proc_status.find(key);
  if (at == std::string::npos) return -1;
  std::istringstream value(proc_status.substr(at + key.size()));
  double kib = 0;
  return value >> kib ? kib / 1024.0 : -1;
}

}  // namespace rtd::launcher
