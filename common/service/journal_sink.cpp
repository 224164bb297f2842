// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/journal_sink.hpp"

#include <sys/stat.h>
#include <sys/uio.h>
#include <syslog.h>
#include <systemd/sd-journal.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace rtd::service {
namespace {

int priority(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::trace:
    case spdlog::level::debug:
      return LOG_DEBUG;
    case spdlog::level::warn:
      return LOG_WARNING;
    case spdlog::level::err:
      return LOG_ERR;
    case spdlog::level::critical:
      return LOG_CRIT;
    default:
      return LOG_INFO;
  }
}

/// "cause" as a field's name; empty when it cannot be one.
std::string field_name(std::string_view key) {
  std::string name = "RTD_";
  for (const char c : key) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') return {};
    name += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return key.empty() ? std::string() : name;
}

}  // namespace

std::vector<std::string> journal_fields(std::string_view line) {
  std::vector<std::string> fields;
  while (!line.empty()) {
    const std::size_t equals = line.find_first_of("= ");
    if (equals == std::string_view::npos) break;
    if (line[equals] == ' ') {
      line.remove_prefix(equals + 1);
      continue;
    }
    const std::string name = field_name(line.substr(0, equals));
    line.remove_prefix(equals + 1);
    const bool quoted = line.starts_with('"');
    if (quoted) line.remove_prefix(1);
    const std::size_t end = std::min(line.find(quoted ? '"' : ' '), line.size());
    if (!name.empty()) fields.push_back(name + '=' + std::string(line.substr(0, end)));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return fields;
}

bool stderr_is_journal() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat file {};
  return stream != nullptr && fstat(STDERR_FILENO, &file) == 0 &&
         std::to_string(file.st_dev) + ':' + std::to_string(file.st_ino) == stream;
}

void JournalSink::sink_it_(const spdlog::details::log_msg& message) {
  const std::string_view line(message.payload.data(), message.payload.size());
  std::vector<std::string> fields = journal_fields(line);
  fields.push_back("MESSAGE=" + std::string(line));
  fields.push_back("PRIORITY=" + std::to_string(priority(message.level)));
  fields.push_back("SYSLOG_IDENTIFIER=rtd-" + service_);
  std::vector<iovec> parts;
  parts.reserve(fields.size());
  for (std::string& field : fields) parts.push_back({field.data(), field.size()});
  sd_journal_sendv(parts.data(), static_cast<int>(parts.size()));
}

}  // namespace rtd::service
