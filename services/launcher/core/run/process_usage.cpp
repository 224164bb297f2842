// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/process_usage.hpp"

#include <sstream>

namespace rtd::launcher {

long long cpu_ticks(const std::string& proc_stat) {
  // proc(5): "pid (comm) state ppid ... utime(14) stime(15) ..."
  const std::size_t end_of_name = proc_stat.rfind(')');
  if (end_of_name == std::string::npos) return -1;
  std::istringstream fields(proc_stat.substr(end_of_name + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  long long user = 0, system = 0;
  return fields >> user >> system ? user + system : -1;
}

double peak_rss_mb(const std::string& proc_status) {
  const std::string key = "VmHWM:";
  const std::size_t at = proc_status.find(key);
  if (at == std::string::npos) return -1;
  std::istringstream value(proc_status.substr(at + key.size()));
  double kib = 0;
  return value >> kib ? kib / 1024.0 : -1;
}

}  // namespace rtd::launcher
