// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>

namespace rtd::bench {

inline std::int64_t read_clock_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

/// Comparable between the processes of a host.
inline std::int64_t monotonic_ns() {
  return read_clock_ns(CLOCK_MONOTONIC);
}

/// CPU time of this process, all threads, against the time on the wall.
class CpuMeter {
 public:
  void start() {
    wall_ns_ = monotonic_ns();
    cpu_ns_ = read_clock_ns(CLOCK_PROCESS_CPUTIME_ID);
  }
  double percent(std::int64_t without_ns = 0) const {
    const auto wall = static_cast<double>(monotonic_ns() - wall_ns_);
    const auto cpu = static_cast<double>(read_clock_ns(CLOCK_PROCESS_CPUTIME_ID) - cpu_ns_ - without_ns);
    return wall > 0 ? 100 * cpu / wall : 0;
  }

 private:
  std::int64_t wall_ns_ = 0, cpu_ns_ = 0;
};

}  // namespace rtd::bench
