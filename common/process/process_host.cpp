// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/process_host.hpp"

#include <sys/resource.h>

#include <cstring>

namespace rtd::process {

std::string describe(const ProcessExit& exit) {
  if (exit.signal == 0) return "exit code " + std::to_string(exit.code);
  const char* name = sigabbrev_np(exit.signal);
  return "killed by signal " + std::to_string(exit.signal) + (name == nullptr ? "" : std::string(" (SIG") + name + ")");
}

double cpu_s(const rusage& usage) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace rtd::process
