// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Preloaded into an attacker whose certificate is expired: to it, it is CLOCK_SHIFT_S seconds later (or earlier).

#include <cstdlib>
#include <ctime>

extern "C" std::time_t time(std::time_t* out) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  const char* const shift = std::getenv("CLOCK_SHIFT_S");
  const std::time_t shifted = now.tv_sec + (shift == nullptr ? 0 : std::atoll(shift));
  if (out != nullptr) *out = shifted;
  return shifted;
}
