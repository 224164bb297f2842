// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/service_logs.hpp"

#include <utility>

namespace rtd::launcher {
namespace {

constexpr int kMaxShownPerService = 10;

/// "warning slam event=..." of "12:34:56.789 warning slam event=..."; empty for a line that is not a log event: the
/// reason of a death is reported together with the death.
std::string event_of(const std::string& line) {
  const std::size_t space = line.find(' ');
  const bool has_time = space == 12 && line[2] == ':' && line[5] == ':';
  return has_time ? line.substr(space + 1) : std::string();
}

}  // namespace

void ServiceLogs::add(const std::string& service, const std::string& line) {
  Log& log = logs_[service];
  if (!log.file.is_open()) log.file.open(path(service), std::ios::trunc);
  log.file << line << '\n' << std::flush;
  log.tail.add(line);
  if (!muted_ && level_of(line) != LogLevel::kInfo) show(service, log, line);
}

void ServiceLogs::show(const std::string& service, Log& log, const std::string& line) {
  const std::string event = event_of(line);
  if (event.empty()) return;
  ++log.shown;
  if (log.shown <= kMaxShownPerService) terminal_.warn("  " + event);
  if (log.shown == kMaxShownPerService)
    terminal_.warn("  (further warnings of " + service + ": " + path(service) + ")");
}

std::vector<std::string> ServiceLogs::reason(const std::string& service) const {
  std::vector<std::string> lines = reason_lines(tail(service));
  const bool shown = lines.size() == 1 && !event_of(lines.front()).empty();
  return shown ? std::vector<std::string>() : lines;
}

std::vector<std::string> ServiceLogs::tail(const std::string& service) const {
  const auto log = logs_.find(service);
  return log == logs_.end() ? std::vector<std::string>() : log->second.tail.lines();
}

}  // namespace rtd::launcher
