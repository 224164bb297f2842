// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/process/service_logs.hpp"

#include <algorithm>

#include "common/io/printable.hpp"

namespace rtd::launcher {
namespace {

constexpr int kMaxShownPerService = 10;
constexpr std::size_t kTailLines = 12;

std::string_view second_token(std::string_view line) {
  const std::size_t space = line.find(' ');
  if (space == std::string_view::npos) return {};
  const std::string_view rest = line.substr(space + 1);
  return rest.substr(0, rest.find(' '));
}

/// The text without ANSI colour sequences around it.
std::string_view strip_color(std::string_view text) {
  while (!text.empty() && text.front() == '\033') text.remove_prefix(std::min(text.find('m'), text.size() - 1) + 1);
  return text.substr(0, text.find('\033'));
}

/// "warning slam event=..." of "12:34:56.789 warning slam event=..."; empty for a line that is not a log event: the
/// reason of a death is reported together with the death.
std::string event_of(const std::string& line) {
  const std::size_t space = line.find(' ');
  const bool has_time = space == 12 && line[2] == ':' && line[5] == ':';
  return has_time ? line.substr(space + 1) : std::string();
}

}  // namespace

LogLevel level_of(std::string_view line) {
  if (line.rfind("rtd-", 0) == 0 || line.rfind("terminate called", 0) == 0) return LogLevel::kError;
  const std::string_view text = strip_color(second_token(line));
  if (text == "warning") return LogLevel::kWarning;
  if (text == "error" || text == "critical") return LogLevel::kError;
  return LogLevel::kInfo;
}

std::vector<std::string> reason_lines(const std::vector<std::string>& tail) {
  for (auto line = tail.rbegin(); line != tail.rend(); ++line) {
    if (level_of(*line) == LogLevel::kError) return {*line};
  }
  return tail;
}

void ServiceLogs::add(const std::string& service, const std::string& printed) {
  const std::string line = io::printable(printed, io::LineEnds::kKeep);  // libraries print, too
  Log& log = logs_[service];
  try {
    if (!log.file) log.file.emplace(path(service), io::IfExists::kReplace);
    log.file->append({io::bytes_of(line), io::bytes_of("\n")});
  } catch (const io::IoError&) {  // a disk that is full may have room again for a later line
  }
  log.tail.push_back(line);
  if (log.tail.size() > kTailLines) log.tail.pop_front();
  if (!muted_ && level_of(line) != LogLevel::kInfo) show(service, log, line);
}

void ServiceLogs::show(const std::string& service, Log& log, const std::string& line) {
  const std::string event = event_of(line);
  if (event.empty()) return;
  if (!hidden_.empty() && event.find("event=" + hidden_ + " ") != std::string::npos) return;
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
  if (log == logs_.end()) return {};
  return {log->second.tail.begin(), log->second.tail.end()};
}

}  // namespace rtd::launcher
