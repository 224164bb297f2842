// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/units_text.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <ctime>

namespace rtd::service {

std::string bytes_text(std::uint64_t bytes) {
  if (bytes < 1000) return fmt::format("{} B", bytes);
  constexpr std::array kUnits = {"kB", "MB", "GB", "TB"};
  double value = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  for (; value >= 999.5 && unit + 1 < kUnits.size(); ++unit) value /= 1000;
  return fmt::format("{:.{}f} {}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0, kUnits[unit]);
}

std::string seconds_text(std::uint64_t duration_ns) {
  return fmt::format("{:.3f} s", static_cast<double>(duration_ns) * 1e-9);
}

std::string time_text(std::uint64_t time_ns) {
  constexpr std::uint64_t kNsPerSecond = 1'000'000'000, kYear2000S = 946'684'800, kYear2100S = 4'102'444'800;
  const std::uint64_t seconds = time_ns / kNsPerSecond;
  if (seconds < kYear2000S || seconds >= kYear2100S) return seconds_text(time_ns);
  const std::tm utc = fmt::gmtime(static_cast<std::time_t>(seconds));
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03} UTC", utc, time_ns % kNsPerSecond / 1'000'000);
}

}  // namespace rtd::service
