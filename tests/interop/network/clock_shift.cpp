// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// For LD_PRELOAD: the process sees CLOCK_REALTIME ahead by RTD_TEST_CLOCK_SHIFT_MS, as on a host whose clock is wrong.
// Namespaces of Linux cannot do that.
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>

extern "C" int clock_gettime(clockid_t clock, timespec* time) {
  const long result = syscall(SYS_clock_gettime, clock, time);
  if (result != 0 || clock != CLOCK_REALTIME) return static_cast<int>(result);
  static const long long shift_ms = [] {
    const char* text = std::getenv("RTD_TEST_CLOCK_SHIFT_MS");
    return text == nullptr ? 0LL : std::atoll(text);
  }();
  const long long total_ns = time->tv_nsec + (shift_ms % 1000) * 1'000'000;
  time->tv_sec += shift_ms / 1000 + total_ns / 1'000'000'000;
  time->tv_nsec = total_ns % 1'000'000'000;
  if (time->tv_nsec < 0) {
    time->tv_nsec += 1'000'000'000;
    --time->tv_sec;
  }
  return 0;
}
